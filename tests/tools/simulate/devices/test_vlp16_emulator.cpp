#include "tools/simulate/devices/vlp16_emulator.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>

namespace curbstone::simulate::devices {
namespace {

using Bytes = LidarEmulator::Bytes;

// shared/reference/protocols/vlp16_helios16p.md, section 4: 0.40 deg a block.
constexpr double kRpm = 0.4 / 110.592e-6 / 6.0;

std::vector<LidarShot> shots(float range_m, std::uint8_t intensity) {
  return std::vector<LidarShot>(16, LidarShot{range_m, intensity});
}

Bytes packet_of(Vlp16Emulator& emulator, std::int64_t utime, double azimuth, const std::vector<LidarShot>& strongest,
                const std::vector<LidarShot>& last) {
  for (int i = 0;; ++i) {
    if (auto packet = emulator.add_firing(utime, azimuth + 0.2 * i, strongest, last)) {
      EXPECT_EQ(i + 1, emulator.table().firings_per_packet);
      return *packet;
    }
  }
}

Bytes slice(const Bytes& bytes, std::size_t at, std::size_t count) {
  return {bytes.begin() + static_cast<std::ptrdiff_t>(at), bytes.begin() + static_cast<std::ptrdiff_t>(at + count)};
}

TEST(Vlp16Emulator, WritesTheBytesOfTheManualsLayout) {
  Vlp16Emulator emulator({.rpm = kRpm, .mode = ReturnMode::kStrongest});
  const Bytes packet =
      packet_of(emulator, 3'600'000'000LL * 400'000 + 140'554'572, 358.7, shots(10, 100), shots(20, 9));
  ASSERT_EQ(packet.size(), 1206U);
  EXPECT_EQ(slice(packet, 300, 7), (Bytes{0xFF, 0xEE, 0x96, 0x8C, 0x88, 0x13, 0x64})) << "359.90 deg, 10.000 m, 100";
  EXPECT_EQ(slice(packet, 300 + 4 + 93, 3), (Bytes{0x88, 0x13, 0x64})) << "the last record of the second firing";
  EXPECT_EQ(slice(packet, 400, 4), (Bytes{0xFF, 0xEE, 0x1E, 0x00})) << "0.30 deg";
  EXPECT_EQ(slice(packet, 1200, 6), (Bytes{0x4C, 0xB1, 0x60, 0x08, 0x37, 0x22}));
}

TEST(Vlp16Emulator, ReportsTheLastEchoFirstInADualPacket) {
  Vlp16Emulator emulator({.rpm = kRpm, .mode = ReturnMode::kDual});
  const Bytes packet = packet_of(emulator, 0, 10.0, shots(0.02F, 5), shots(0.04F, 7));
  EXPECT_EQ(slice(packet, 0, 7), (Bytes{0xFF, 0xEE, 0xE8, 0x03, 20, 0, 7})) << "even block: last";
  EXPECT_EQ(slice(packet, 100, 7), (Bytes{0xFF, 0xEE, 0xE8, 0x03, 10, 0, 5})) << "odd block: strongest";
  EXPECT_EQ(slice(packet, 200, 4), (Bytes{0xFF, 0xEE, 0x10, 0x04})) << "the next pair, two firings on";
  EXPECT_EQ(packet[1204], 0x39);
}

TEST(Vlp16Emulator, ReportsTheEchoOfItsMode) {
  Vlp16Emulator emulator({.rpm = kRpm, .mode = ReturnMode::kLast});
  const Bytes packet = packet_of(emulator, 0, 10.0, shots(0.02F, 5), shots(0.04F, 7));
  EXPECT_EQ(slice(packet, 4, 3), (Bytes{20, 0, 7}));
  EXPECT_EQ(packet[1204], 0x38);
}

TEST(Vlp16Emulator, SendsNoReturnForRangesItCannotSay) {
  Vlp16Emulator emulator;
  std::vector<LidarShot> some = shots(0, 9);
  some[1].range_m = 131.08F;
  some[2].range_m = 131.07F;
  const Bytes packet = packet_of(emulator, 0, 0, some, some);
  EXPECT_EQ(slice(packet, 4, 9), (Bytes{0, 0, 0, 0, 0, 0, 0xFF, 0xFF, 9}));
}

TEST(Vlp16Emulator, LooksWhereTheManualSays) {
  const Vlp16Emulator emulator({.rpm = kRpm, .mode = ReturnMode::kStrongest});
  std::array<LidarRay, 16> rays;
  const auto target = [&](double azimuth, std::size_t laser) -> Eigen::Vector3d {
    emulator.beams(azimuth, rays);
    return rays[laser].origin + 10.0 * rays[laser].direction;
  };
  EXPECT_TRUE(target(359.9, 0).isApprox(Eigen::Vector3d(9.65924, 0.01686, -2.57699), 1e-6));
  EXPECT_TRUE(target(359.9, 15).isApprox(Eigen::Vector3d(9.65926, -0.00421, 2.57699), 1e-6));
  EXPECT_TRUE(target(0.1, 0).isApprox(Eigen::Vector3d(9.65924, -0.01686, -2.57699), 1e-6));
  EXPECT_TRUE(target(0.1, 15).isApprox(Eigen::Vector3d(9.65918, -0.03793, 2.57699), 1e-6));
  EXPECT_NEAR(rays[15].time_offset, 15 * 2.304e-6, 1e-12);
}

TEST(Vlp16Emulator, TellsItsTimeAndTheGpsSentenceInThePositionPacket) {
  // 2021-10-01 01:02:03.273546 UTC.
  const Bytes packet = Vlp16Emulator().info(1'633'050'123'273'546);
  ASSERT_EQ(packet.size(), 512U);
  EXPECT_EQ(slice(packet, 198, 5), (Bytes{0x4A, 0x01, 0x59, 0x07, 2})) << "123.273546 s past the hour; PPS locked";
  const std::string text(packet.begin() + 206, packet.end());
  EXPECT_EQ(text.substr(0, text.find('\0')), "$GPRMC,010203,A,5231.2000,N,01324.3000,E,000.0,000.0,011021,,,A*73\r\n");
}

}  // namespace
}  // namespace curbstone::simulate::devices
