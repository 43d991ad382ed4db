#include <gtest/gtest.h>

#include <bit>

#include "drivers/lidar/models/robosense/packet_time.hpp"

namespace curbstone::lidar::models::robosense {
namespace {

PacketTime from_bytes(const std::array<std::uint8_t, 10>& bytes) {
  return std::bit_cast<PacketTime>(bytes);
}

// rs16.md section 3: the worked example of rs_driver's test/basic_attr_test.cpp, taken as UTC.
TEST(PacketTime, ReadsTheWorkedExampleAsUtc) {
  EXPECT_EQ(utime_from(from_bytes({0x15, 0x0A, 0x01, 0x01, 0x02, 0x03, 0x01, 0x11, 0x02, 0x22})), 1633050123273546);
}

TEST(PacketTime, WritesWhatItReads) {
  for (const std::int64_t utime : {946684800000000, 1633050123273546, 1709164799999999, 1709251200000000}) {
    EXPECT_EQ(utime_from(packet_time_from(utime)), utime);
  }
}

TEST(PacketTime, DoesNotDependOnTheTimeZone) {
  setenv("TZ", "Asia/Shanghai", 1);
  tzset();
  EXPECT_EQ(utime_from(packet_time_from(1633050123273546)), 1633050123273546);
  unsetenv("TZ");
  tzset();
}

TEST(PacketTime, RefusesWhatIsNoTime) {
  const std::array<std::uint8_t, 10> good = {0x15, 0x0A, 0x01, 0x01, 0x02, 0x03, 0x01, 0x11, 0x02, 0x22};
  const std::pair<std::size_t, std::uint8_t> faults[] = {{1, 0},  {1, 13}, {2, 0},        {2, 32},  {3, 24},
                                                         {4, 60}, {5, 60}, {6, 0x03 + 1}, {8, 0x04}};
  for (const auto& [index, value] : faults) {
    auto bytes = good;
    bytes[index] = value;
    EXPECT_FALSE(utime_from(from_bytes(bytes))) << "byte " << index << " = " << int{value};
  }
  EXPECT_FALSE(utime_from(from_bytes({17, 2, 29, 0, 0, 0, 0, 0, 0, 0})));  // 2017 had no 29 February
}

}  // namespace
}  // namespace curbstone::lidar::models::robosense
