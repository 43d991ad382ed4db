#include "drivers/lidar/decoding/record_bytes.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>

namespace curbstone::lidar::decoding {
namespace {

TEST(RecordBytes, AreADistanceAndAnIntensityEach) {
  std::mt19937 random(1);
  for (int round = 0; round < 100; ++round) {
    std::array<std::uint8_t, kRecordBytes * kRecordsPerBlock> bytes;
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
    BlockRecords records;
    records.repeats = 3;
    take_records(bytes, records);
    EXPECT_EQ(records.repeats, 0);
    for (std::size_t i = 0; i < kRecordsPerBlock; ++i) {
      EXPECT_EQ(records.distance[i], bytes[3 * i] * 256 + bytes[3 * i + 1]) << i;
      EXPECT_EQ(records.intensity[i], bytes[3 * i + 2]) << i;
    }
  }
}

}  // namespace
}  // namespace curbstone::lidar::decoding
