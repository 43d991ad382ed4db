#include "tools/output/inputs.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "tests/temporary_folder.hpp"

namespace curbstone::output {
namespace {

TEST(Inputs, AreNotOverwrittenByWhateverName) {
  const test::TemporaryFolder folder;
  const std::string log = folder / "drive.lcmlog";
  const std::string other = folder / "other.lcmlog";
  std::ofstream(log) << "x";
  std::ofstream(other) << "x";
  std::filesystem::create_symlink("drive.lcmlog", folder / "link");
  std::filesystem::create_hard_link(log, folder / "second_name");
  std::filesystem::create_directory(folder / "sub");
  for (const char* name : {"drive.lcmlog", "link", "second_name", "sub/../drive.lcmlog"})
    EXPECT_THROW(refuse_to_overwrite({other, log}, folder / name), std::runtime_error) << name;
  EXPECT_NO_THROW(refuse_to_overwrite({log}, other));
}

TEST(Inputs, ThatAreNotThereOrNotNamedAreInNobodysWay) {
  const test::TemporaryFolder folder;
  EXPECT_NO_THROW(refuse_to_overwrite({folder / "none"}, folder / "none"));
  EXPECT_NO_THROW(refuse_to_overwrite({folder / "none", ""}, ""));
  EXPECT_NO_THROW(refuse_to_overwrite({"2368"}, "/dev/null"));
}

}  // namespace
}  // namespace curbstone::output
