#include <gmock/gmock.h>

#include <fstream>

#include "services/viewer/web/assets.hpp"
#include "tests/paths.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::viewer::web {
namespace {

using ::testing::HasSubstr;

TEST(AssetsTest, ThePageIsInTheProgramAndAsksNobodyElse) {
  const auto page = find_asset("/", "");
  ASSERT_TRUE(page.has_value());
  EXPECT_THAT(page->bytes, HasSubstr("<!doctype html>"));
  std::size_t size = 0;
  for (const char* path : {"/page.js", "/page.css", "/icon.svg"}) {
    EXPECT_THAT(page->bytes, HasSubstr('"' + std::string(path + 1) + '"')) << "beside it, behind a proxy too";
    const auto asset = find_asset(path, "");
    ASSERT_TRUE(asset.has_value()) << path;
    EXPECT_GT(asset->bytes.size(), 100U);
    size += asset->bytes.size();
    for (std::size_t at = asset->bytes.find("://"); at != std::string::npos; at = asset->bytes.find("://", at + 3))
      EXPECT_TRUE(asset->bytes.compare(at, 10, "://www.w3.") == 0 ||
                  asset->bytes.substr(at - 5, 5).find("ws") != std::string::npos)
          << path << ": " << asset->bytes.substr(at - 10, 40);
  }
  EXPECT_LT(size, 120'000U);
}

TEST(AssetsTest, AreNamesAndNoPaths) {
  for (const char* path :
       {"", "/index.html", "//", "/../ugv.yaml", "/page.js/", "/etc/passwd", "page.js", "/page.js%00"})
    EXPECT_FALSE(find_asset(path, "/").has_value()) << path;
}

TEST(AssetsTest, CanComeFromAFolder) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "page.js") << "let a;";
  EXPECT_EQ(find_asset("/page.js", folder.path().string())->bytes, "let a;");
  EXPECT_FALSE(find_asset("/page.css", folder.path().string()).has_value());
}

/// The folder that the README names is where the build puts the files.
TEST(AssetsTest, TheFolderOfTheBundleHasAllThatTheProgramHas) {
  const std::string folder = test::build_path("services/viewer/page/bundle");
  for (const char* path : {"/", "/page.js", "/page.css", "/icon.svg"}) {
    const auto from_folder = find_asset(path, folder);
    ASSERT_TRUE(from_folder.has_value()) << path;
    EXPECT_EQ(from_folder->bytes, find_asset(path, "")->bytes) << path;
  }
}

}  // namespace
}  // namespace curbstone::viewer::web
