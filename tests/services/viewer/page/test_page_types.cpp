#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <string>

#include "services/viewer/page/page_files.hpp"
#include "tests/paths.hpp"

namespace curbstone::viewer {
namespace {

TEST(PageTypes, AgreeAsTheTypeScriptCompilerSees) {
  if (access("/usr/bin/tsc", X_OK) != 0) GTEST_SKIP() << "no tsc: scripts/install-deps --long";
  const std::string command = "cd " + test::source_path("services/viewer/page") +
                              " && tsc --noEmit --strict --noUnusedLocals --noUnusedParameters "
                              "--target es2020 --lib es2021,dom,dom.iterable --moduleResolution node main.ts 2>&1";
  FILE* tsc = popen(command.c_str(), "r");
  ASSERT_NE(tsc, nullptr);
  std::string said;
  for (int c = std::fgetc(tsc); c != EOF; c = std::fgetc(tsc)) said.push_back(static_cast<char>(c));
  EXPECT_EQ(pclose(tsc), 0) << said;
}

TEST(PageFiles, AreSmallEnoughForALinkByRadio) {
  const std::size_t all =
      page::index_html().size() + page::page_js().size() + page::page_css().size() + page::icon_svg().size();
  EXPECT_LE(all, 120'000U);
  EXPECT_GT(all, 20'000U);
}

}  // namespace
}  // namespace curbstone::viewer
