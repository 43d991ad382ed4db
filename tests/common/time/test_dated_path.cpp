#include "common/time/dated_path.hpp"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "tests/temporary_folder.hpp"

namespace curbstone {
namespace {

using ::testing::EndsWith;

constexpr std::int64_t kUtime = 1'795'452'693'900'000;  // 2026-11-23 16:51:33.9 UTC

TEST(DatedPath, IsOfTheSecondInUtcAndTheFirstThatIsFree) {
  const test::TemporaryFolder folder;
  const std::string stem = (folder.path() / "map").string();
  const auto take = [](const std::string& path) { std::ofstream(path) << 'x'; };
  EXPECT_EQ(free_dated_path(stem, kUtime, ".db"), stem + "-20261123T165133Z.db");
  take(stem + "-20261123T165133Z.db");
  EXPECT_EQ(free_dated_path(stem, kUtime, ".db"), stem + "-20261123T165133Z-2.db");
  take(stem + "-20261123T165133Z-2.db");
  EXPECT_EQ(free_dated_path(stem, kUtime, ".db"), stem + "-20261123T165133Z-3.db");
  EXPECT_EQ(free_dated_path(stem, kUtime), stem + "-20261123T165133Z") << "a folder of the same time is another name";
}

TEST(DatedPath, OfAFolderWithDotsKeepsThem) {
  EXPECT_THAT(free_dated_path("maps/town.v2", kUtime), EndsWith("town.v2-20261123T165133Z"));
}

}  // namespace
}  // namespace curbstone
