#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "drivers/lidar/models/rs16/device_info.hpp"
#include "drivers/lidar/models/rs16/rs16_decoder.hpp"
#include "tests/stamps.hpp"
#include "tools/simulate/devices/rs16_emulator.hpp"

namespace curbstone::lidar {
namespace {

using test::kStart;

TEST(Rs16Emulator, WritesTheBytesOfTheProtocol) {
  simulate::devices::Rs16Emulator emulator({.rpm = 600});
  std::array<simulate::devices::LidarShot, models::rs16::kLasers> shots{};
  shots[0] = {10.0F, 77};
  std::optional<models::rs16::Rs16Packet> packet;
  for (int i = 0; i < 24; ++i) {
    ASSERT_FALSE(packet);
    packet = emulator.add_sequence(1633050123273546, 359.0 + i * 0.2, shots);
  }
  ASSERT_TRUE(packet);
  const models::rs16::Rs16Packet& bytes = *packet;
  const auto at = [&](std::size_t i, std::size_t n) { return std::vector<int>(&bytes[i], &bytes[i] + n); };
  EXPECT_EQ(at(0, 8), (std::vector<int>{0x55, 0xAA, 0x05, 0x0A, 0x5A, 0xA5, 0x50, 0xA0}));
  EXPECT_EQ(at(20, 10), (std::vector<int>{0x15, 0x0A, 0x01, 0x01, 0x02, 0x03, 0x01, 0x11, 0x02, 0x22}));
  EXPECT_EQ(at(42, 7), (std::vector<int>{0xFF, 0xEE, 0x8C, 0x3C, 0x07, 0xD0, 77}));  // 35900, 2000
  EXPECT_EQ(at(42 + 4 + 48, 3), (std::vector<int>{0x07, 0xD0, 77}));                 // the block's second sequence
  EXPECT_EQ(at(42 + 300, 4), (std::vector<int>{0xFF, 0xEE, 0x00, 0x14}));            // 360.20 is 0.20 deg
  EXPECT_EQ(at(1246, 2), (std::vector<int>{0x00, 0xFF}));
}

TEST(Rs16Emulator, SendsNoReturnForRangesItCannotSay) {
  simulate::devices::Rs16Emulator emulator;
  std::array<simulate::devices::LidarShot, models::rs16::kLasers> shots{};
  const float ranges[] = {0.0F, -1.0F, NAN, INFINITY, 327.68F, 0.002F, 327.675F};
  for (std::size_t i = 0; i < std::size(ranges); ++i) shots[i] = {ranges[i], 9};
  std::optional<models::rs16::Rs16Packet> bytes;
  for (int i = 0; i < 24; ++i) bytes = emulator.add_sequence(kStart, 0, shots);
  const auto packet = std::bit_cast<models::rs16::MsopPacket>(*bytes);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(packet.blocks[0].records[i].distance, 0) << ranges[i];
  EXPECT_EQ(packet.blocks[0].records[6].distance, 65535);
}

/// What decoder and emulator must agree on: where each shot of a drive went, and when.
TEST(Rs16Emulator, IsReadBackByTheDecoder) {
  for (const int rpm : {300, 600, 1200}) {
    simulate::devices::Rs16Emulator emulator({.rpm = static_cast<double>(rpm)});
    models::rs16::Rs16Decoder decoder({0.1, 300});
    decoder.set_device(models::rs16::parse_difop(emulator.difop(kStart, rpm)).info);
    decoding::DecodedPacket decoded;
    std::vector<Eigen::Vector3d> origins, directions;
    std::vector<double> ranges, times;
    for (int i = 0; i < 24 * 40; ++i) {
      const double azimuth = i * emulator.azimuth_step();
      const double start = i % 24 * models::rs16::kSequencePeriod;
      std::array<simulate::devices::LidarShot, models::rs16::kLasers> shots;
      for (std::size_t laser = 0; laser < models::rs16::kLasers; ++laser) {
        const simulate::devices::LidarRay ray = emulator.rays(azimuth)[laser];
        const double range = 2.0 + 0.0371 * ((i * 16 + static_cast<int>(laser)) % 2000);
        shots[laser] = {static_cast<float>(range), static_cast<std::uint8_t>(laser)};
        origins.push_back(ray.origin);
        directions.push_back(ray.direction);
        ranges.push_back(range);
        times.push_back(start + ray.time_offset);
      }
      const std::int64_t utime = kStart + static_cast<std::int64_t>(i) * 111 / 2;
      const auto packet = emulator.add_sequence(utime, azimuth, shots);
      if (!packet) continue;
      ASSERT_EQ(decoder.decode(*packet, decoded), decoding::Refusal::kNone);
      ASSERT_EQ(decoded.stamp, kStart + i / 24 * 1332);
      ASSERT_EQ(decoded.x.size(), 384U);
      for (std::size_t k = 0; k < decoded.x.size(); ++k) {
        const Eigen::Vector3d beam = Eigen::Vector3d(decoded.x[k], decoded.y[k], decoded.z[k]) - origins[k];
        ASSERT_NEAR(beam.norm(), ranges[k], 0.0025 + 1e-4);
        const double angle = std::acos(std::min(1.0, beam.normalized().dot(directions[k]))) * 180 / M_PI;
        ASSERT_LT(angle, 0.01) << "laser " << k % 16 << " of sequence " << k / 16;
        ASSERT_NEAR(decoded.time_offset[k], times[k], 1e-9);
      }
      origins.clear();
      directions.clear();
      ranges.clear();
      times.clear();
    }
  }
}

}  // namespace
}  // namespace curbstone::lidar
