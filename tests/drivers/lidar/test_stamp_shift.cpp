#include "drivers/lidar/stamp_shift.hpp"

#include <gtest/gtest.h>

#include "tests/drivers/lidar/captures.hpp"
#include "tests/drivers/lidar/packets.hpp"

namespace curbstone::lidar {
namespace {

Bytes helios_packet(std::initializer_list<int> stamp) {
  Bytes bytes(20);
  bytes[0] = 0x55;
  bytes[1] = 0xAA;
  bytes[2] = 0x05;
  bytes[3] = 0x5A;
  put(bytes, stamp);
  bytes.resize(1248);
  return bytes;
}

Bytes vlp16_packet(std::initializer_list<int> stamp) {
  Bytes bytes(1200);
  put(bytes, stamp);
  bytes.resize(1206);
  return bytes;
}

TEST(StampShift, SetsTheCalendarTimeOfAnRs16Forward) {
  models::rs16::MsopPacket before = empty_packet();
  before.time = models::robosense::packet_time_from(1'699'999'999'999'000);
  models::rs16::MsopPacket after = before;
  after.time = models::robosense::packet_time_from(1'700'000'000'001'500);
  models::rs16::Rs16Packet bytes = bytes_of(before);
  shift_stamp(bytes, 2500);
  EXPECT_EQ(bytes, bytes_of(after));
}

TEST(StampShift, SetsTheSecondsAndMicrosecondsOfAHeliosForward) {
  // 1483724884.201573 + 0.8 s = 1483724885.001573; vlp16_helios16p.md, section 4.
  Bytes bytes = helios_packet({0x00, 0x00, 0x58, 0x6F, 0xD8, 0x54, 0x00, 0x03, 0x13, 0x65});
  shift_stamp(bytes, 800'000);
  EXPECT_EQ(bytes, helios_packet({0x00, 0x00, 0x58, 0x6F, 0xD8, 0x55, 0x00, 0x00, 0x06, 0x25}));
}

TEST(StampShift, TurnsOverAtTheHourOfAVlp16) {
  Bytes bytes = vlp16_packet({0xFF, 0xA3, 0x93, 0xD6});  // 3599.999999 s
  shift_stamp(bytes, 2);
  EXPECT_EQ(bytes, vlp16_packet({0x01, 0x00, 0x00, 0x00}));
}

TEST(StampShift, LeavesAloneWhatIsNoStamp) {
  for (Bytes bytes : {Bytes{}, Bytes(512), Bytes(1248), Bytes(1248, 0xFF),
                      helios_packet({0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0, 0, 0, 0}),
                      helios_packet({0, 0, 0, 0, 0, 1, 0xFF, 0xFF, 0xFF, 0xFF})}) {
    const Bytes before = bytes;
    shift_stamp(bytes, 1'000'000);
    EXPECT_EQ(bytes, before);
  }
  models::rs16::MsopPacket unset = empty_packet();
  unset.time = {};
  models::rs16::Rs16Packet bytes = bytes_of(unset);
  shift_stamp(bytes, 1'000'000);
  EXPECT_EQ(bytes, bytes_of(unset));
}

}  // namespace
}  // namespace curbstone::lidar
