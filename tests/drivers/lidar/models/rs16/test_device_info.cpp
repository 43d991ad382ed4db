#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <random>

#include "drivers/lidar/models/rs16/device_info.hpp"
#include "tests/drivers/lidar/packets.hpp"

namespace curbstone::lidar::models::rs16 {
namespace {

DifopResult parse(const DifopPacket& packet) {
  return parse_difop(std::bit_cast<Rs16Packet>(packet));
}

TEST(DeviceInfo, KeepsTheAnglesToATenThousandthOfADegree) {
  DifopPacket packet = info_packet();
  // rs16.md section 8.1: 00 27 10 is 1.0000 deg, 02 49 F0 is 15.0000 deg.
  packet.elevation[0].bytes[0] = 0x02;
  packet.elevation[0].bytes[1] = 0x49;
  packet.elevation[0].bytes[2] = 0xF0;
  packet.elevation[15].bytes[0] = 0x00;
  packet.elevation[15].bytes[1] = 0x27;
  packet.elevation[15].bytes[2] = 0x10;
  packet.elevation[8] = 150094;
  const DifopResult result = parse(packet);
  ASSERT_EQ(result.refusal, decoding::Refusal::kNone);
  EXPECT_TRUE(result.info.calibrated);
  EXPECT_DOUBLE_EQ(result.info.elevations[0], -15.0);  // lasers 1 to 8 look down
  EXPECT_DOUBLE_EQ(result.info.elevations[15], 1.0);
  EXPECT_DOUBLE_EQ(result.info.elevations[8], 15.0094);
}

TEST(DeviceInfo, KeepsTheNominalAnglesWhereTheTableIsBlank) {
  for (const std::uint8_t fill : {std::uint8_t{0x00}, std::uint8_t{0xFF}}) {
    DifopPacket packet = info_packet();
    for (Be24& angle : packet.elevation) std::fill_n(angle.bytes, 3, fill);
    const DifopResult result = parse(packet);
    ASSERT_EQ(result.refusal, decoding::Refusal::kNone);
    EXPECT_FALSE(result.info.calibrated);
    EXPECT_EQ(result.info.elevations, kNominalElevations);
  }
}

TEST(DeviceInfo, RefusesAnglesThatNoRs16Has) {
  DifopPacket packet = info_packet();
  packet.elevation[3] = 500'000;
  EXPECT_EQ(parse(packet).refusal, decoding::Refusal::kDifopAngles);
}

TEST(DeviceInfo, KnowsTheFirmwareThatCountsInCentimetres) {
  DifopPacket packet = info_packet();
  EXPECT_EQ(parse(packet).info.distance_step, 0.005);
  for (const auto& old : {std::array<std::uint8_t, 3>{0, 0, 0}, {0xFF, 0xFF, 0xFF}, {0x55, 0xAA, 0x5A}, {0xE9, 1, 0}}) {
    std::copy(old.begin(), old.end(), packet.firmware.begin() + 1);
    EXPECT_EQ(parse(packet).info.distance_step, 0.01);
    EXPECT_EQ(parse(packet).info.times, kOldFiringTimes) << "it also fires faster";
  }
}

TEST(DeviceInfo, BelievesDualReturnOnlyOfABoardThatKnowsIt) {
  DifopPacket packet = info_packet();
  packet.return_mode = 0;
  packet.bottom_firmware = {0x08, 0x02, 0x09, 0, 0};
  EXPECT_TRUE(parse(packet).info.dual_return);
  packet.bottom_firmware = {0x08, 0x02, 0x08, 0, 0};
  EXPECT_FALSE(parse(packet).info.dual_return);
}

TEST(DeviceInfo, ReadsTheSuppliesWhereTheirChannelsAreNumbered) {
  DifopPacket packet = info_packet();
  const std::array<std::uint16_t, 6> recorded = {0x069C, 0x16A0, 0x27EB, 0x3A93, 0x4832, 0x53E1};
  std::ranges::copy(recorded, packet.voltages.begin());
  EXPECT_THAT(parse(packet).status.millivolts, ::testing::ElementsAre(4948, 3304, 2561, 1212));
  packet.voltages[3] = 0x4A93;
  EXPECT_THAT(parse(packet).status.millivolts, ::testing::ElementsAre(0, 0, 0, 0));
}

TEST(DeviceInfo, ReadsAFieldOfViewThroughZero) {
  DifopPacket packet = info_packet();
  packet.fov_start = 24000;
  packet.fov_end = 8000;
  EXPECT_EQ(parse(packet).info.fov_start, 24000);
  EXPECT_EQ(parse(packet).info.fov_end, 8000);
  packet.fov_end = 36001;
  EXPECT_EQ(parse(packet).info.fov_start, 0) << "no angle: the whole turn";
}

TEST(DeviceInfo, RefusesLengthMagicAndForeignReturnModes) {
  const Rs16Packet good = std::bit_cast<Rs16Packet>(info_packet());
  for (std::size_t size = 0; size < good.size(); size += 13) {
    EXPECT_EQ(parse_difop({good.data(), size}).refusal, decoding::Refusal::kLength);
  }
  for (std::size_t i = 0; i < 8; ++i) {
    Rs16Packet bad = good;
    bad[i] ^= 0x10;
    EXPECT_EQ(parse_difop(bad).refusal, decoding::Refusal::kMagic);
  }
  DifopPacket helios = info_packet();
  helios.return_mode = 4;
  EXPECT_EQ(parse(helios).refusal, decoding::Refusal::kDifopMode);
}

TEST(DeviceInfo, NeverGivesAnglesThatNoRs16HasWhateverComes) {
  std::mt19937 random(7);
  for (int i = 0; i < 20'000; ++i) {
    Rs16Packet bytes = std::bit_cast<Rs16Packet>(info_packet());
    for (int k = 0; k < 40; ++k) bytes[8 + random() % (bytes.size() - 8)] = static_cast<std::uint8_t>(random());
    const DifopResult result = parse_difop(bytes);
    if (result.refusal != decoding::Refusal::kNone) continue;
    for (std::size_t laser = 0; laser < kLasers; ++laser) {
      ASSERT_NEAR(result.info.elevations[laser], kNominalElevations[laser], 2.0);
    }
    ASSERT_TRUE(result.info.fov_start <= 36000 && result.info.fov_end <= 36000);
  }
}

}  // namespace
}  // namespace curbstone::lidar::models::rs16
