#include "tools/simulate/devices/helios_emulator.hpp"

#include <gtest/gtest.h>

namespace curbstone::simulate::devices {
namespace {

using Bytes = LidarEmulator::Bytes;

std::vector<LidarShot> shots(const HeliosEmulator& emulator, float range_m, std::uint8_t intensity) {
  return std::vector<LidarShot>(static_cast<std::size_t>(emulator.table().lasers), LidarShot{range_m, intensity});
}

/// `step`: deg from one firing to the next.
Bytes packet_of(HeliosEmulator& emulator, std::int64_t utime, double azimuth, double step,
                const std::vector<LidarShot>& strongest, const std::vector<LidarShot>& last) {
  for (int i = 0;; ++i) {
    if (auto packet = emulator.add_firing(utime, azimuth + step * i, strongest, last)) {
      EXPECT_EQ(i + 1, emulator.table().firings_per_packet);
      return *packet;
    }
  }
}

Bytes part(const Bytes& bytes, std::size_t at, std::size_t count) {
  return {bytes.begin() + static_cast<std::ptrdiff_t>(at), bytes.begin() + static_cast<std::ptrdiff_t>(at + count)};
}

HeliosEmulator helios(int lasers, ReturnMode mode = ReturnMode::kStrongest) {
  return HeliosEmulator({.lasers = lasers, .rpm = 600, .mode = mode, .angles = {}});
}

// The recording shared/data/rs16/helios16p.pcap; vlp16_helios16p.md, section 4.
TEST(HeliosEmulator, WritesTheBytesOfARecordedPacketOf32Lasers) {
  HeliosEmulator emulator = helios(32);
  const auto wall = shots(emulator, 8.255F, 8);
  const Bytes packet = packet_of(emulator, 1'483'724'884'201'573, 4.73, 0.19, wall, wall);
  ASSERT_EQ(packet.size(), 1248U);
  EXPECT_EQ(part(packet, 0, 6), (Bytes{0x55, 0xAA, 0x05, 0x5A, 0x00, 0x01}));
  EXPECT_EQ(packet[17], 1);
  EXPECT_EQ(part(packet, 20, 11), (Bytes{0x00, 0x00, 0x58, 0x6F, 0xD8, 0x54, 0x00, 0x03, 0x13, 0x65, 0x06}));
  EXPECT_EQ(part(packet, 42, 4), (Bytes{0xFF, 0xEE, 0x01, 0xD9}));
  EXPECT_EQ(part(packet, 42 + 4 + 60, 3), (Bytes{0x0C, 0xE6, 0x08}));
  EXPECT_EQ(part(packet, 142, 4), (Bytes{0xFF, 0xEE, 0x01, 0xEC}));
  EXPECT_EQ(part(packet, 1246, 2), (Bytes{0x00, 0xFF}));
}

TEST(HeliosEmulator, LooksWhereTheRecordedDeviceOf32LasersDoes) {
  const HeliosEmulator emulator(
      {.lasers = 32, .rpm = 0.19 / 55.56e-6 / 6.0, .mode = ReturnMode::kStrongest, .angles = {}});
  std::vector<LidarRay> rays(32);
  emulator.beams(4.73, rays);
  const Eigen::Vector3d target = rays[20].origin + 8.255 * rays[20].direction;
  EXPECT_TRUE(target.isApprox(Eigen::Vector3d(7.69253, -0.09362, -3.08169), 2e-6)) << target.transpose();
  EXPECT_NEAR(rays[20].time_offset, 34.6e-6, 1e-12);
}

TEST(HeliosEmulator, LooksWhereTheFactsSayWith16Lasers) {
  std::vector<HeliosAngles> angles(16);
  angles[1] = {13, 1.5};
  const HeliosEmulator emulator(
      {.lasers = 16, .rpm = 0.4 / 111.12e-6 / 6.0, .mode = ReturnMode::kStrongest, .angles = angles});
  std::vector<LidarRay> rays(16);
  emulator.beams(100.2, rays);
  const Eigen::Vector3d target = rays[1].origin + 4.0 * rays[1].direction;
  EXPECT_TRUE(target.isApprox(Eigen::Vector3d(-0.79732, -3.85077, 0.89980), 2e-6)) << target.transpose();
}

TEST(HeliosEmulator, PutsTwoFiringsOf16LasersIntoABlock) {
  HeliosEmulator emulator = helios(16);
  std::vector<LidarShot> wall = shots(emulator, 4.0F, 50);
  const Bytes packet = packet_of(emulator, 0, 100.0, 0.2, wall, wall);
  EXPECT_EQ(emulator.table().firings_per_packet, 24);
  EXPECT_EQ(part(packet, 42, 7), (Bytes{0xFF, 0xEE, 0x27, 0x10, 0x06, 0x40, 50})) << "100.00 deg, 4.000 m";
  EXPECT_EQ(part(packet, 42 + 4 + 51, 3), (Bytes{0x06, 0x40, 50})) << "record 17";
  EXPECT_EQ(part(packet, 142, 4), (Bytes{0xFF, 0xEE, 0x27, 0x38})) << "100.40 deg";
  EXPECT_EQ(packet[30], 0x07);
}

TEST(HeliosEmulator, PutsBothEchoesOf16LasersIntoABlock) {
  HeliosEmulator emulator = helios(16, ReturnMode::kDual);
  const Bytes packet = packet_of(emulator, 0, 100.0, 0.2, shots(emulator, 0.0025F, 1), shots(emulator, 0.005F, 2));
  EXPECT_EQ(emulator.table().firings_per_packet, 12);
  EXPECT_EQ(part(packet, 46, 3), (Bytes{0, 1, 1}));
  EXPECT_EQ(part(packet, 46 + 48, 3), (Bytes{0, 2, 2}));
  EXPECT_EQ(part(packet, 142, 4), (Bytes{0xFF, 0xEE, 0x27, 0x24})) << "100.20 deg";
}

TEST(HeliosEmulator, PutsBothEchoesOf32LasersIntoAPairOfBlocks) {
  HeliosEmulator emulator = helios(32, ReturnMode::kDual);
  const Bytes packet = packet_of(emulator, 0, 100.0, 0.2, shots(emulator, 0.0025F, 1), shots(emulator, 0.005F, 2));
  EXPECT_EQ(emulator.table().firings_per_packet, 6);
  EXPECT_EQ(part(packet, 42, 7), (Bytes{0xFF, 0xEE, 0x27, 0x10, 0, 1, 1}));
  EXPECT_EQ(part(packet, 142, 7), (Bytes{0xFF, 0xEE, 0x27, 0x10, 0, 2, 2}));
  EXPECT_EQ(part(packet, 242, 4), (Bytes{0xFF, 0xEE, 0x27, 0x24}));
}

TEST(HeliosEmulator, TellsModeSpeedTimeAndAnglesInDifop) {
  HeliosEmulator emulator = helios(16, ReturnMode::kLast);
  const Bytes info = emulator.info(1'483'724'884'201'573);
  ASSERT_EQ(info.size(), 1248U);
  EXPECT_EQ(part(info, 0, 10), (Bytes{0xA5, 0xFF, 0x00, 0x5A, 0x11, 0x11, 0x55, 0x55, 0x02, 0x58}));
  EXPECT_EQ(info[300], 5);
  EXPECT_EQ(part(info, 303, 10), (Bytes{0x00, 0x00, 0x58, 0x6F, 0xD8, 0x54, 0x00, 0x03, 0x13, 0x65}));
  EXPECT_EQ(part(info, 468, 3), (Bytes{0x00, 0x05, 0xD6})) << "laser 0: +14.94 deg";
  EXPECT_EQ(part(info, 468 + 45, 3), (Bytes{0x01, 0x05, 0xDF})) << "laser 15: -15.03 deg";
  EXPECT_EQ(part(info, 564, 3), (Bytes{0x01, 0x01, 0x92})) << "laser 0: -4.02 deg";
  EXPECT_EQ(part(info, 1246, 2), (Bytes{0x0F, 0xF0}));
}

}  // namespace
}  // namespace curbstone::simulate::devices
