#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <random>

#include "drivers/lidar/models/helios/helios_model.hpp"
#include "drivers/lidar/packet_feed.hpp"
#include "tests/drivers/lidar/bench.hpp"
#include "tests/drivers/lidar/models/helios/helios_packets.hpp"
#include "tests/paths.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::lidar::models::helios {
namespace {

using decoding::DecodedPacket;
using decoding::Refusal;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::string kRecording = test::data_path("rs16/helios16p.pcap");

DecodedPacket decode(const Variant& variant, const MsopPacket& packet, const Bytes& device) {
  HeliosDecoder decoder(variant, {0.0, 200.0}, std::nullopt);
  decoder.set_device(parse_difop(device).info);
  DecodedPacket decoded;
  EXPECT_EQ(decoder.decode(bytes_of(packet), decoded), Refusal::kNone);
  return decoded;
}

// vlp16_helios16p.md, section 4: record 17 of a block at 100.00 deg, the next at 100.40; laser 1 at V +13, H +1.5.
TEST(Helios16p, PlacesAPointAsTheWorkedExample) {
  MsopPacket packet = points(10000, 40);
  packet.blocks[0].records[17] = {0x0640, 9};
  const DecodedPacket decoded = decode(k16p, packet, info(16));
  ASSERT_EQ(decoded.x.size(), 1U);
  EXPECT_NEAR(decoded.x[0], -0.79732, 1e-5);
  EXPECT_NEAR(decoded.y[0], -3.85077, 1e-5);
  EXPECT_NEAR(decoded.z[0], 0.89980, 1e-5);
  EXPECT_NEAR(decoded.time_offset[0], 58.71e-6, 1e-9);
  EXPECT_EQ(decoded.stamp, kUtc);
  EXPECT_NEAR(decoded.duration, 1333.44e-6, 1e-9);
}

TEST(Helios16p, ReadsTwoReturnsOfAShotAndSaysOneOnce) {
  MsopPacket packet = points(10000, 20);
  packet.blocks[1].records[3] = {1000, 5};
  packet.blocks[1].records[19] = {1600, 6};
  packet.blocks[2].records[4] = packet.blocks[2].records[20] = {1000, 5};
  const DecodedPacket decoded = decode(k16p, packet, info(16, 0));
  ASSERT_EQ(decoded.x.size(), 3U);
  EXPECT_FLOAT_EQ(decoded.time_offset[0], 55.56e-6F + 9.45e-6F);
  EXPECT_FLOAT_EQ(decoded.time_offset[1], decoded.time_offset[0]);
  EXPECT_NEAR(decoded.duration, 666.72e-6, 1e-9);
}

TEST(Helios32, ReadsTwoReturnsFromPairsOfBlocks) {
  MsopPacket packet = points(10000, 0);
  for (std::size_t b = 0; b < kBlocksPerPacket; ++b)
    packet.blocks[b].azimuth = static_cast<std::uint16_t>(10000 + 20 * (b / 2));
  packet.blocks[2].records[20] = {1000, 5};
  packet.blocks[3].records[20] = {1600, 6};
  const DecodedPacket decoded = decode(k32, packet, info(32, 0));
  ASSERT_EQ(decoded.x.size(), 2U);
  EXPECT_FLOAT_EQ(decoded.time_offset[0], 55.56e-6F + 34.6e-6F);
  EXPECT_NEAR(decoded.duration, 333.36e-6, 1e-9);
}

TEST(Helios, CountsInTheUnitOfThePacketAndNoDamagedByteSwitchesIt) {
  HeliosDecoder decoder(k16p, {0.0, 400.0}, std::nullopt);
  decoder.set_device(parse_difop(info(16)).info);
  DecodedPacket decoded;
  MsopPacket packet = points(10000, 40);
  packet.blocks[0].records[0] = {4000, 1};
  ASSERT_EQ(decoder.decode(bytes_of(packet), decoded), Refusal::kNone);
  EXPECT_NEAR(std::hypot(decoded.x.at(0), decoded.y.at(0), decoded.z.at(0)), 10.0F, 0.05F);
  packet.distance_unit = MsopPacket::k5mm;
  for (int i = 0; i < 9; ++i) EXPECT_EQ(decoder.decode(bytes_of(packet), decoded), Refusal::kBlock);
  ASSERT_EQ(decoder.decode(bytes_of(packet), decoded), Refusal::kNone) << "ten in a row: it was set so";
  EXPECT_NEAR(std::hypot(decoded.x.at(0), decoded.y.at(0), decoded.z.at(0)), 20.0F, 0.05F);
  packet.distance_unit = 7;
  EXPECT_EQ(decoder.decode(bytes_of(packet), decoded), Refusal::kBlock);
}

TEST(HeliosInfo, KnowsHowManyLasersThereAre) {
  EXPECT_EQ(parse_difop(info(16)).info.lasers, 16);
  EXPECT_EQ(parse_difop(info(32)).info.lasers, 32);
  EXPECT_EQ(parse_difop(info(0)).info.lasers, 0);
  EXPECT_EQ(parse_difop(info(16, 2)).refusal, Refusal::kDifopMode);
  EXPECT_TRUE(parse_difop(info(16, 0)).info.dual_return);
}

TEST(HeliosNode, SendsNothingBeforeItsAnglesAreKnownAndSaysSo) {
  Bench bench(config_for(ModelName::kHelios16p));
  const auto send = [&](int i) {
    MsopPacket packet = points(i * 480, 40, kUtc + i * 1333);
    packet.blocks[0].records[0] = {1000, 1};
    bench.send(bytes_of(packet), kUtc + (i + 1) * 1333);
  };
  for (int i = 0; i < 20; ++i) {
    bench.node.tick(kUtc + i * 100'000);
    send(i);
  }
  EXPECT_THAT(bench.points, IsEmpty());
  EXPECT_EQ(bench.count("refused.no_angles"), 20);
  EXPECT_THAT(bench.node.report().faults, Contains(HasSubstr("angles_file")));
  bench.send(info(32), kUtc, robosense::kDifopPort);
  EXPECT_EQ(bench.count("refused.difop_angles"), 1) << "one of 32 lasers is no 16P";
  bench.send(info(16), kUtc, robosense::kDifopPort);
  send(20);
  EXPECT_THAT(bench.points, IsEmpty()) << "one may be damaged: a second must agree";
  bench.send(info(16), kUtc, robosense::kDifopPort);
  for (int i = 21; i < 31; ++i) send(i);
  EXPECT_EQ(bench.points.size(), 10U);
  EXPECT_EQ(bench.count("device.rpm"), 599);
}

TEST(HeliosNode, TakesItsAnglesFromAFileInstead) {
  const test::TemporaryFolder folder;
  LidarConfig config = config_for(ModelName::kHelios16p);
  config.angles_file = folder / "angles.csv";
  std::ofstream file(config.angles_file);
  file << "\xEF\xBB\xBF# elevation, azimuth\r\n";
  for (int i = 0; i < 16; ++i) file << (i % 2 == 0 ? " " : "") << 13 - (i - 1) << "," << 1.5 << "\n";
  file.close();
  Bench bench(config);
  for (int i = 0; i < 3; ++i) {
    MsopPacket packet = points(10000 + i * 480, 40, kUtc + i * 1333);
    packet.blocks[0].records[17] = {0x0640, 9};
    bench.send(bytes_of(packet), kUtc + (i + 1) * 1333);
  }
  ASSERT_EQ(bench.points.size(), 3U);
  EXPECT_NEAR(bench.points[0].x.at(0), -0.79732, 1e-5);
  std::ofstream(config.angles_file) << "1.0\n2.0,\n";
  EXPECT_THAT([&] { Bench other(config); },
              ::testing::ThrowsMessage<std::runtime_error>(HasSubstr("angles.csv:2: expected elevation[,azimuth]")));
  std::ofstream(config.angles_file) << "1.0\n2.0\n";
  EXPECT_THAT([&] { Bench other(config); },
              ::testing::ThrowsMessage<std::runtime_error>(HasSubstr("has 16 lasers, the file 2")));
  std::ofstream(config.angles_file) << "-15,0;0,5\n";
  EXPECT_THAT([&] { Bench other(config); }, ::testing::ThrowsMessage<std::runtime_error>(
                                                HasSubstr("angles.csv:1: expected elevation[,azimuth] in deg with "
                                                          "decimal points")));
  std::ofstream(config.angles_file) << "-15\n-13,5\n";
  EXPECT_THAT([&] { Bench other(config); },
              ::testing::ThrowsMessage<std::runtime_error>(HasSubstr("angles.csv:2: is this comma a decimal one?")));
}

TEST(HeliosNode, BelievesTheOnlyInformationOfACapture) {
  Bench bench(config_for(ModelName::kHelios16p));
  bench.node.expect_one_info();
  bench.send(info(16), kUtc, robosense::kDifopPort);
  for (int i = 0; i < 3; ++i) {
    MsopPacket packet = points(10000 + i * 480, 40, kUtc + i * 1333);
    packet.blocks[0].records[0] = {1000, 1};
    bench.send(bytes_of(packet), kUtc + (i + 1) * 1333);
  }
  EXPECT_EQ(bench.points.size(), 3U);
}

TEST(HeliosNode, DoesNotBelieveTheOnlyInformationWhereItIsDamaged) {
  const auto set = [](std::size_t at, int byte) { return std::pair{at, static_cast<std::uint8_t>(byte)}; };
  for (const auto& [at, byte] : {set(8, 0x42), set(352, 0x42), set(469 + 3 * 4, 2), set(470 + 3 * 4, 0x20), set(468, 1),
                                 set(565 + 3 * 7, 9), set(300, 3), set(468 + 3 * 9, 7)}) {
    Bench bench(config_for(ModelName::kHelios16p));
    bench.node.expect_one_info();
    Bytes damaged = info(16);
    damaged[at] = byte;
    bench.send(damaged, kUtc, robosense::kDifopPort);
    for (int i = 0; i < 3; ++i)
      bench.send(bytes_of(points(10000 + i * 480, 40, kUtc + i * 1333)), kUtc + (i + 1) * 1333);
    EXPECT_EQ(bench.points.size(), 0U) << at;
    EXPECT_EQ(bench.count("refused.difop_angles") + bench.count("refused.difop_mode"), 1) << at;
  }
}

TEST(HeliosNode, ADamagedFirstInformationSetsNothingWhereMoreCome) {
  Bench bench(config_for(ModelName::kHelios16p));
  Bytes damaged = info(16, 0);
  damaged[470] = static_cast<std::uint8_t>(damaged[470] + 7);
  bench.send(damaged, kUtc, robosense::kDifopPort);
  MsopPacket packet = points(10000, 40, kUtc);
  bench.send(bytes_of(packet), kUtc + 1333);
  EXPECT_EQ(bench.count("refused.no_angles"), 1);
  for (int i = 0; i < 2; ++i) bench.send(info(16), kUtc, robosense::kDifopPort);
  for (int i = 1; i < 4; ++i) {
    packet = points(10000 + i * 480, 40, kUtc + i * 1333);
    packet.blocks[0].records[0] = {1000, 1};
    bench.send(bytes_of(packet), kUtc + (i + 1) * 1333);
  }
  ASSERT_EQ(bench.points.size(), 3U);
  EXPECT_NEAR(bench.points[0].z.at(0), 2.5 * std::sin(14.0 * M_PI / 180), 1e-5);
}

TEST(HeliosNode, OneDamagedInformationDoesNotChangeTheAngles) {
  Bench bench(config_for(ModelName::kHelios16p));
  for (int i = 0; i < 2; ++i) bench.send(info(16), kUtc, robosense::kDifopPort);
  Bytes damaged = info(16, 0);  // two returns, and another angle
  damaged[470] = static_cast<std::uint8_t>(damaged[470] + 7);
  bench.send(damaged, kUtc, robosense::kDifopPort);
  for (int i = 0; i < 3; ++i) {
    MsopPacket packet = points(10000 + i * 480, 40, kUtc + i * 1333);
    packet.blocks[0].records[0] = {1000, 1};
    bench.send(bytes_of(packet), kUtc + (i + 1) * 1333);
  }
  ASSERT_EQ(bench.points.size(), 3U);
  EXPECT_NEAR(bench.points[0].z.at(0), 2.5 * std::sin(14.0 * M_PI / 180), 1e-5);
}

class HeliosRecording : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kRecording)) GTEST_SKIP() << kRecording << " is not there";
  }
};

// The device information is the 544th packet of the file; the points after it are decoded.
TEST_F(HeliosRecording, IsReadAsTheThirtyTwoLasersThatItIs) {
  for (const ModelName model : {ModelName::kHelios32, ModelName::kAuto}) {
    LidarConfig config = config_for(model);
    config.pcap = kRecording;
    Bench bench(config);
    EXPECT_EQ(feed_whole_capture(config, bench.node), 751);
    bench.bus.dispatch();
    EXPECT_EQ(bench.count("packets") + bench.count("refused.no_angles") + bench.count("undecided"), 750);
    EXPECT_EQ(bench.points.size(), 207U);
    EXPECT_EQ(bench.count("lost.packets"), 0);
    EXPECT_EQ(bench.count("device.rpm"), 599);
    EXPECT_EQ(bench.count("clock.device"), 0) << "it reads 2017";
    int rings = 0;
    for (const lidar_points_t& message : bench.points) {
      for (const auto ring : message.ring) rings = std::max(rings, static_cast<int>(ring));
    }
    EXPECT_EQ(rings, 31);
  }
}

// vlp16_helios16p.md, section 4: the first point packet, record 20 of block 0.
TEST_F(HeliosRecording, PlacesAPointAsTheWorkedExample) {
  const auto packets = recording(kRecording);
  HeliosDecoder decoder(k32, {0.0, 200.0}, std::nullopt);
  for (const RecordedPacket& packet : packets)
    if (packet.port == robosense::kDifopPort) decoder.set_device(parse_difop(packet.bytes).info);
  DecodedPacket decoded;
  ASSERT_EQ(decoder.decode(packets.front().bytes, decoded), Refusal::kNone);
  EXPECT_EQ(decoded.stamp, 1483724884201573);
  bool found = false;
  for (std::size_t i = 0; i < decoded.x.size(); ++i) {
    if (std::abs(decoded.time_offset[i] - 34.6e-6F) > 1e-9F) continue;
    found = true;
    EXPECT_NEAR(decoded.x[i], 7.69253, 1e-5);
    EXPECT_NEAR(decoded.y[i], -0.09362, 1e-5);
    EXPECT_NEAR(decoded.z[i], -3.08169, 1e-5);
    EXPECT_EQ(decoded.intensity[i], 8);
  }
  EXPECT_TRUE(found);
}

TEST_F(HeliosRecording, IsRefusedByNameUnder16pAndVlp16) {
  for (const ModelName model : {ModelName::kHelios16p, ModelName::kVlp16}) {
    LidarConfig config = config_for(model);
    config.pcap = kRecording;
    Bench bench(config);
    feed_whole_capture(config, bench.node);
    EXPECT_EQ(bench.count("refused.helios32"), 750);
    EXPECT_EQ(bench.count("packets"), 0);
  }
}

TEST(HeliosNode, SurvivesAnyBytes) {
  Bench bench(config_for(ModelName::kHelios16p));
  std::mt19937 random(4);
  for (int i = 0; i < 4000; ++i) {
    MsopPacket packet = points(i * 480, 40, kUtc + i * 1333);
    for (auto& record : packet.blocks[random() % 12].records) record.distance = static_cast<std::uint16_t>(random());
    Bytes bytes = i % 10 == 3 ? info(16) : bytes_of(packet);
    for (auto k = random() % 5; k > 0; --k) bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    bench.send(bytes, kUtc + (i + 1) * 1333);
  }
  EXPECT_GT(bench.points.size(), 1000U);
  for (const lidar_points_t& message : bench.points)
    ASSERT_TRUE(std::ranges::all_of(message.x, [](float x) { return std::isfinite(x); }));
}

}  // namespace
}  // namespace curbstone::lidar::models::helios
