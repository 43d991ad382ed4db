#include "common/file_kind/file_kind.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace curbstone {
namespace {

using ::testing::StartsWith;
using namespace std::string_literals;

std::string_view kind_of(const std::string& head) {
  return file_kind(std::span(reinterpret_cast<const std::uint8_t*>(head.data()), head.size()));
}

TEST(FileKind, IsToldByTheFirstBytes) {
  EXPECT_THAT(kind_of("\xED\xA1\xDA\x01 and on"), StartsWith("an LCM log: 'curbstone replay'"));
  EXPECT_THAT(kind_of("\x1F\x8B\x08"), StartsWith("a file compressed by gzip: unpack it first"));
  EXPECT_THAT(kind_of("\x28\xB5\x2F\xFD\x04"), StartsWith("a file compressed by zstd"));
  EXPECT_THAT(kind_of("\xFD"
                      "7zXZ\0\0"s),
              StartsWith("a file compressed by xz"));
  EXPECT_THAT(kind_of("PK\x03\x04"), StartsWith("a ZIP archive"));
  EXPECT_THAT(kind_of(std::string(257, 'n') + "ustar"), StartsWith("a tar archive"));
  EXPECT_THAT(kind_of("#ROSBAG V2.0\n"), StartsWith("a bag of ROS 1"));
  EXPECT_THAT(kind_of("\x89MCAP0\r\n"), StartsWith("an MCAP file"));
  EXPECT_THAT(kind_of("\xD4\xC3\xB2\xA1"), StartsWith("a capture of packets"));
  EXPECT_THAT(kind_of("\x0A\x0D\x0D\x0A"), StartsWith("a capture of packets"));
  EXPECT_THAT(kind_of("# .PCD v0.7"), StartsWith("a point cloud"));
}

TEST(FileKind, AMapAndAnotherFileOfSqliteDiffer) {
  std::string head = "SQLite format 3\0"s + std::string(84, '\0');
  EXPECT_THAT(kind_of(head), StartsWith("an SQLite file"));
  EXPECT_THAT(kind_of(head.substr(0, 20)), StartsWith("an SQLite file"));
  head.replace(68, 4, "CURB");
  EXPECT_THAT(kind_of(head), StartsWith("a map: 'curbstone view'"));
}

TEST(FileKind, OfWhatIsNotKnownNothingIsSaid) {
  EXPECT_EQ(kind_of(""), "");
  EXPECT_EQ(kind_of("x"), "");
  EXPECT_EQ(kind_of(std::string(512, 'x')), "");
  EXPECT_EQ(file_kind("/nowhere/at/all"s), "");
  EXPECT_EQ(file_kind(std::filesystem::temp_directory_path().string()), "");
}

}  // namespace
}  // namespace curbstone
