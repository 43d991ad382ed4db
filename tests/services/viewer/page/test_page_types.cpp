#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <string>

namespace curbstone::viewer {
namespace {

TEST(PageTypes, AgreeAsTheTypeScriptCompilerSees) {
  if (access("/usr/bin/tsc", X_OK) != 0) GTEST_SKIP() << "no tsc: scripts/install-deps --tests";
  const std::string command = "cd " CURBSTONE_SOURCE_DIR
                              "/services/viewer/page && tsc --noEmit --strict --noUnusedLocals --noUnusedParameters "
                              "--target es2020 --lib es2021,dom,dom.iterable --moduleResolution node main.ts 2>&1";
  FILE* tsc = popen(command.c_str(), "r");
  ASSERT_NE(tsc, nullptr);
  std::string said;
  for (int c = std::fgetc(tsc); c != EOF; c = std::fgetc(tsc)) said.push_back(static_cast<char>(c));
  EXPECT_EQ(pclose(tsc), 0) << said;
}

}  // namespace
}  // namespace curbstone::viewer
