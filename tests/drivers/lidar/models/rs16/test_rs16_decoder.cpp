#include "drivers/lidar/models/rs16/rs16_decoder.hpp"

#include <gmock/gmock.h>

#include <Eigen/Core>
#include <random>

#include "tests/drivers/lidar/packets.hpp"

namespace curbstone::lidar::models::rs16 {
namespace {

using decoding::DecodedPacket;

DecodedPacket decode(const models::rs16::MsopPacket& packet, const models::rs16::DeviceInfo& device = {}) {
  Rs16Decoder decoder({0.0, 400.0});
  decoder.set_device(device);
  DecodedPacket decoded;
  EXPECT_EQ(decoder.decode(bytes_of(packet), decoded), decoding::Refusal::kNone);
  return decoded;
}

/// Azimuth of a point, clockwise.
double degrees(const DecodedPacket& packet, std::size_t i) {
  return std::atan2(-static_cast<double>(packet.y[i]), static_cast<double>(packet.x[i])) * 180 / M_PI;
}

// rs16.md section 6: raw distance 2000, azimuth 30.00 deg, next block 0.40 deg further.
TEST(Rs16Decoder, PlacesPointsAsTheWorkedExamples) {
  models::rs16::MsopPacket packet = empty_packet(3000, 40);
  for (const int record : {0, 8, 16}) packet.blocks[0].records[record] = {2000, static_cast<std::uint8_t>(record)};
  const DecodedPacket decoded = decode(packet);
  ASSERT_EQ(decoded.x.size(), 3U);

  EXPECT_NEAR(decoded.x[0], 8.39829, 1e-5);
  EXPECT_NEAR(decoded.y[0], -4.84875, 1e-5);
  EXPECT_NEAR(decoded.z[0], -2.58819, 1e-5);
  EXPECT_NEAR(decoded.z[1], 2.58819, 1e-5);
  EXPECT_NEAR(decoded.x[2], 8.38131, 1e-5);
  EXPECT_NEAR(decoded.y[2], -4.87804, 1e-5);
  EXPECT_NEAR(decoded.z[2], -2.58819, 1e-5);

  EXPECT_EQ(decoded.time_offset[0], 0.0F);
  EXPECT_FLOAT_EQ(decoded.time_offset[1], 22.4e-6F);
  EXPECT_FLOAT_EQ(decoded.time_offset[2], 55.5e-6F);
  EXPECT_THAT(std::vector<int>(decoded.ring.begin(), decoded.ring.end()), testing::ElementsAre(0, 15, 0));
  EXPECT_THAT(std::vector<int>(decoded.intensity.begin(), decoded.intensity.end()), testing::ElementsAre(0, 8, 16));
}

TEST(Rs16Decoder, TakesTheLastPointOfAPacketAtItsOwnTime) {
  models::rs16::MsopPacket packet = empty_packet();
  packet.blocks[11].records[31].distance = 1000;
  EXPECT_FLOAT_EQ(decode(packet).time_offset.at(0), 1318.5e-6F);
}

// The manual: 0x0642 is 16.02 m in centimetres or 8.01 m in half centimetres.
TEST(Rs16Decoder, CountsInTheDevicesDistanceStep) {
  models::rs16::MsopPacket packet = empty_packet();
  packet.blocks[0].records[0].distance = 0x0642;
  models::rs16::DeviceInfo device;
  device.elevations[0] = 0;
  EXPECT_FLOAT_EQ(decode(packet, device).x.at(0), 8.01F + 0.03825F);
  device.distance_step = 0.01;
  EXPECT_FLOAT_EQ(decode(packet, device).x.at(0), 16.02F + 0.03825F);
}

TEST(Rs16Decoder, RanksTheRingsByTheDevicesOwnElevations) {
  models::rs16::MsopPacket packet = empty_packet();
  for (models::rs16::MsopRecord& record : std::span(packet.blocks[0].records, models::rs16::kLasers))
    record.distance = 1000;
  const auto rings = [&](const models::rs16::DeviceInfo& device) {
    const DecodedPacket decoded = decode(packet, device);
    return std::vector<int>(decoded.ring.begin(), decoded.ring.end());
  };
  EXPECT_THAT(rings({}), testing::ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 15, 14, 13, 12, 11, 10, 9, 8));
}

TEST(Rs16Decoder, LeavesOutWhatIsOutOfRangeAndSaysHowMuch) {
  models::rs16::MsopPacket packet = empty_packet();
  for (int i = 0; i < 4; ++i) packet.blocks[0].records[i].distance = static_cast<std::uint16_t>(1 + 10'000 * i);
  Rs16Decoder decoder({0.4, 149.0});
  DecodedPacket decoded;
  ASSERT_EQ(decoder.decode(bytes_of(packet), decoded), decoding::Refusal::kNone);
  EXPECT_EQ(decoded.x.size(), 2U);
  EXPECT_EQ(decoded.out_of_range, 2);
}

TEST(Rs16Decoder, InterpolatesThroughZero) {
  models::rs16::MsopPacket packet = empty_packet(35990, 40);
  packet.blocks[0].records[16].distance = 2000;  // half-way from 359.90 to 0.30: 0.10 deg
  const DecodedPacket decoded = decode(packet);
  EXPECT_NEAR(std::atan2(-decoded.y[0], decoded.x[0]), 0.10F / 180 * static_cast<float>(M_PI), 1e-7F);
}

TEST(Rs16Decoder, TakesBothCodesOfNoReturnForNone) {
  models::rs16::MsopPacket packet = empty_packet();
  for (models::rs16::MsopRecord& record : packet.blocks[3].records) record.distance = 0xFFFF;
  packet.blocks[3].records[7].distance = 0xFFFE;
  const DecodedPacket decoded = decode(packet);
  EXPECT_EQ(decoded.x.size(), 1U);
  EXPECT_EQ(decoded.no_return, 383);
  EXPECT_EQ(decoded.out_of_range, 0);
}

/// Two returns a shot: the block is one firing sequence, its halves are the returns.
TEST(Rs16Decoder, ReadsTwoReturnsOfAShotAndSaysOneOnce) {
  models::rs16::MsopPacket packet = empty_packet(3000, 20);
  packet.blocks[1].records[2] = {2000, 10};
  packet.blocks[1].records[18] = {3000, 20};
  packet.blocks[2].records[5] = {1000, 30};
  packet.blocks[2].records[21] = {1000, 30};
  models::rs16::DeviceInfo device;
  device.dual_return = true;
  device.elevations.fill(0.0);
  const DecodedPacket decoded = decode(packet, device);
  ASSERT_EQ(decoded.x.size(), 3U);
  const double angle = 30.20 + 0.20 * 2 * 2.8 / 55.5;
  EXPECT_NEAR(degrees(decoded, 0), angle, 1e-4);
  EXPECT_NEAR(degrees(decoded, 1), angle, 1e-4);
  EXPECT_NEAR(std::hypot(decoded.x[0], decoded.y[0]), 10.03825, 1e-5);
  EXPECT_NEAR(std::hypot(decoded.x[1], decoded.y[1]), 15.03825, 1e-5);
  EXPECT_FLOAT_EQ(decoded.time_offset[0], 61.1e-6F);
  EXPECT_FLOAT_EQ(decoded.time_offset[1], 61.1e-6F) << "both of one shot";
  EXPECT_NEAR(decoded.duration, 666e-6, 1e-9);
}

TEST(Rs16Decoder, FiresFasterWithOldFirmware) {
  models::rs16::MsopPacket packet = empty_packet();
  packet.blocks[11].records[31].distance = 1000;
  models::rs16::DeviceInfo device;
  device.times = models::rs16::kOldFiringTimes;
  EXPECT_FLOAT_EQ(decode(packet, device).time_offset.at(0), 1195e-6F);  // 11 x 100 + 50 + 15 x 3
  EXPECT_NEAR(decode(packet, device).duration, 1.2e-3, 1e-9);
}

TEST(Rs16Decoder, LeavesOutWhatIsOutsideItsSectorAlsoThroughZero) {
  models::rs16::MsopPacket packet = empty_packet(35980, 40);  // 359.80, 0.20, 0.60, ... deg
  for (auto& block : packet.blocks) block.records[0].distance = 1000;
  const auto points = [&](double start, double end) {
    models::rs16::Rs16Decoder decoder({0.0, 400.0, start, end});
    DecodedPacket decoded;
    EXPECT_EQ(decoder.decode(bytes_of(packet), decoded), decoding::Refusal::kNone);
    return decoded.x.size();
  };
  EXPECT_EQ(points(0, 360), 12U);
  EXPECT_EQ(points(90, 90), 12U);
  EXPECT_EQ(points(0, 10), 11U);
  EXPECT_EQ(points(350, 0.5), 2U);
  EXPECT_EQ(points(0.6, 1.0), 1U) << "half open";
}

TEST(Rs16Decoder, RefusesAndTellsWhy) {
  Rs16Decoder decoder({0.4, 150});
  DecodedPacket decoded;
  const models::rs16::Rs16Packet good = bytes_of(empty_packet());
  for (std::size_t size = 0; size < good.size(); ++size) {
    ASSERT_EQ(decoder.decode({good.data(), size}, decoded), decoding::Refusal::kLength);
  }
  for (std::size_t i = 0; i < 8; ++i) {
    models::rs16::Rs16Packet bad = good;
    bad[i] ^= 0x80;
    EXPECT_EQ(decoder.decode(bad, decoded), decoding::Refusal::kMagic);
  }
  models::rs16::MsopPacket packet = empty_packet();
  packet.blocks[11].flag = 0xFFEF;
  EXPECT_EQ(decoder.decode(bytes_of(packet), decoded), decoding::Refusal::kBlock);
  packet = empty_packet();
  packet.blocks[5].azimuth = 36000;
  EXPECT_EQ(decoder.decode(bytes_of(packet), decoded), decoding::Refusal::kAzimuth);
}

TEST(Rs16Decoder, GivesFinitePointsInRangeWhateverComes) {
  Rs16Decoder decoder({0.4, 150});
  std::mt19937 random(3);
  DecodedPacket decoded;
  int used = 0;
  for (int i = 0; i < 2000; ++i) {
    models::rs16::MsopPacket packet = empty_packet();
    for (models::rs16::MsopBlock& block : packet.blocks) {
      if (i % 2 == 0) block.azimuth = static_cast<std::uint16_t>(random() % 36000);
      for (models::rs16::MsopRecord& record : block.records) record.distance = static_cast<std::uint16_t>(random());
    }
    models::rs16::Rs16Packet bytes = bytes_of(packet);
    for (std::uint32_t flips = random() % 4; flips > 0; --flips)
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    if (decoder.decode(bytes, decoded) != decoding::Refusal::kNone) continue;
    ++used;
    ASSERT_LE(decoded.x.size(), 384U);
    for (std::size_t k = 0; k < decoded.x.size(); ++k) {
      const float range = Eigen::Vector3f(decoded.x[k], decoded.y[k], decoded.z[k]).norm();
      ASSERT_TRUE(range >= 0.4F && range <= 150.1F) << range;
      ASSERT_TRUE(decoded.time_offset[k] >= 0.0F && std::isfinite(decoded.time_offset[k]));
    }
  }
  EXPECT_GT(used, 800);
}

}  // namespace
}  // namespace curbstone::lidar::models::rs16
