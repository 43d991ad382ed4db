// Faults that last, and faults of more than one bit, in a real RS-LiDAR-16's packets: what is bad costs itself.
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <string>

#include "tests/drivers/lidar/faulty_packets.hpp"

namespace curbstone::lidar {
namespace {

using FaultyStreams = FaultyPackets;

std::string counters_of(const Bench& bench) {
  std::string text;
  const NodeReport report = bench.node.report();
  for (const auto& [name, value] : report.counters.values()) text += name + " " + std::to_string(value) + "\n";
  return text;
}

void set_azimuth(RecordedPacket& packet, std::size_t block, int azimuth) {
  packet.bytes[42 + 100 * block + 2] = static_cast<std::uint8_t>(azimuth >> 8);
  packet.bytes[42 + 100 * block + 3] = static_cast<std::uint8_t>(azimuth & 0xFF);
}

int azimuth_of(const RecordedPacket& packet, std::size_t block) {
  return packet.bytes[42 + 100 * block + 2] * 256 + packet.bytes[42 + 100 * block + 3];
}

TEST_F(FaultyStreams, AnAzimuthThatJumpsEitherWayInAnyBlockCostsItsPacket) {
  const auto truth = undisturbed();
  std::mt19937 random(1);
  for (std::size_t block = 0; block < 12; ++block) {
    for (const int off : {300, -300, 4500, -4500, 17999, static_cast<int>(random() % 30000) + 3000}) {
      const RecordedPacket good = point_packet(1500);
      turn_azimuth(point_packet(1500), block, off);
      Bench bench;
      feed(bench);
      EXPECT_EQ(bench.points.size(), kPackets - 1U) << off << " in block " << block << "\n" << counters_of(bench);
      EXPECT_EQ(bench.count("lost.packets"), 0);
      expect_the_same(bench, truth);
      point_packet(1500) = good;
    }
  }
}

TEST_F(FaultyStreams, AStampThatIsALittleWrongCostsItsPacketAtMost) {
  for (int off = -400; off <= 400; off += 25) {
    const RecordedPacket good = point_packet(1500);
    set_stamp(point_packet(1500), stamp(good) + off);
    Bench bench;
    feed(bench);
    EXPECT_GE(bench.points.size(), kPackets - 1U) << off << " us\n" << counters_of(bench);
    EXPECT_EQ(bench.points.size() + static_cast<std::size_t>(bench.refused()), 0U + kPackets);
    EXPECT_EQ(bench.count("lost.packets"), 0) << off;
    point_packet(1500) = good;
  }
}

TEST_F(FaultyStreams, AnAzimuthThatIsNoneCostsItsPacket) {
  const auto truth = undisturbed();
  for (std::size_t block = 0; block < 12; ++block)
    set_azimuth(point_packet(100 + 200 * static_cast<int>(block)), block, 0xFFFF);
  for (std::size_t block = 0; block < 12; ++block) set_azimuth(point_packet(2800), block, 0xFFFF);
  Bench bench;
  feed(bench);
  EXPECT_EQ(bench.points.size(), kPackets - 13U) << counters_of(bench);
  EXPECT_EQ(bench.refused(), 13);
  expect_the_same(bench, truth);
}

TEST_F(FaultyStreams, AnAzimuthThatIsStuckInAPacketCostsIt) {
  const auto truth = undisturbed();
  for (const int index : {500, 501, 1500}) {
    for (std::size_t block = 1; block < 12; ++block)
      set_azimuth(point_packet(index), block, azimuth_of(point_packet(index), 0));
  }
  Bench bench;
  feed(bench);
  EXPECT_EQ(bench.points.size(), kPackets - 3U) << counters_of(bench);
  expect_the_same(bench, truth);
}

TEST_F(FaultyStreams, AnAzimuthThatIsStuckForAWhileCostsThatWhile) {
  const auto truth = undisturbed();
  const int azimuth = azimuth_of(point_packet(999), 11);
  for (int i = 1000; i < 1100; ++i)
    for (std::size_t block = 0; block < 12; ++block) set_azimuth(point_packet(i), block, azimuth);
  Bench bench;
  feed(bench);
  EXPECT_EQ(bench.points.size(), kPackets - 100U) << counters_of(bench);
  expect_the_same(bench, truth);
}

TEST_F(FaultyStreams, BlocksOfOnesAreRefusedAndChannelsOfOnesAreNoReturns) {
  const auto truth = undisturbed();
  auto& blocks = point_packet(700).bytes;
  std::fill(blocks.begin() + 42, blocks.begin() + 1242, std::uint8_t{0xFF});
  auto& one = point_packet(800).bytes;
  std::fill(one.begin() + 42 + 500, one.begin() + 42 + 600, std::uint8_t{0xFF});
  auto& channels = point_packet(900).bytes;
  for (std::size_t block = 0; block < 12; ++block)
    std::fill_n(channels.begin() + static_cast<std::ptrdiff_t>(42 + 100 * block + 4), 96, std::uint8_t{0xFF});
  Bench bench;
  feed(bench);
  EXPECT_EQ(bench.count("refused.block"), 2);
  ASSERT_EQ(bench.points.size(), kPackets - 2U) << counters_of(bench);
  EXPECT_TRUE(std::ranges::any_of(bench.points, [](const auto& message) { return message.num_points == 0; }));
  std::erase_if(bench.points, [](const auto& message) { return message.num_points == 0; });
  expect_the_same(bench, truth);
}

TEST_F(FaultyStreams, APacketOfTwoReturnsFromADeviceOfOneCostsItself) {
  const auto truth = undisturbed();
  for (const int index : {500, 1200, 1201, 2400}) {
    auto& packet = point_packet(index);
    for (std::size_t block = 0; block < 12; block += 2) set_azimuth(packet, block + 1, azimuth_of(packet, block));
  }
  Bench bench;
  feed(bench);
  EXPECT_EQ(bench.points.size(), kPackets - 4U) << counters_of(bench);
  expect_the_same(bench, truth);
}

TEST_F(FaultyStreams, ASecondDeviceOnThePortIsRefused) {
  for (const std::int64_t behind : {std::int64_t{0}, std::int64_t{500'000'000}}) {  // us, the second one's clock
    const auto truth = undisturbed();
    std::vector<RecordedPacket> mixed;
    int points = 0;
    for (const RecordedPacket& packet : packets_) {
      mixed.push_back(packet);
      if (packet.port != models::robosense::kMsopPort || ++points < 20 || points % 2 == 0) continue;
      RecordedPacket other = packet;  // the head is elsewhere
      for (std::size_t block = 0; block < 12; ++block) turn_azimuth(other, block, 12345);
      set_stamp(other, stamp(other) - behind + 400);
      other.received += 300;
      mixed.push_back(other);
    }
    packets_ = mixed;
    Bench bench;
    feed(bench);
    EXPECT_EQ(bench.points.size(), static_cast<std::size_t>(kPackets)) << counters_of(bench);
    EXPECT_EQ(bench.count("lost.packets"), 0);
    expect_the_same(bench, truth);
    SetUp();
  }
}

TEST_F(FaultyStreams, APacketThatComesAgainASecondLaterIsRefused) {
  const auto truth = undisturbed();
  std::vector<RecordedPacket> again;
  std::vector<RecordedPacket> points;
  for (const RecordedPacket& packet : packets_) {
    again.push_back(packet);
    if (packet.port != models::robosense::kMsopPort) continue;
    points.push_back(packet);
    if (points.size() > 751 && points.size() % 100 == 0) {
      again.push_back(points[points.size() - 751]);
      again.back().received = packet.received + 50;
    }
  }
  packets_ = again;
  Bench bench;
  feed(bench);
  EXPECT_EQ(bench.points.size(), static_cast<std::size_t>(kPackets)) << counters_of(bench);
  EXPECT_EQ(bench.refused(), 23);
  expect_the_same(bench, truth);
}

TEST_F(FaultyStreams, StampsThatFreezeForAWhileCostThatWhileAndMoveNoOther) {
  for (const int frozen : {1, 5, 9, 200}) {
    const auto truth = undisturbed();
    for (int i = 1000; i < 1000 + frozen; ++i) set_stamp(point_packet(i), stamp(point_packet(999)));
    Bench bench;
    feed(bench);
    EXPECT_EQ(bench.points.size(), static_cast<std::size_t>(kPackets - frozen)) << counters_of(bench);
    expect_the_same(bench, truth);
    SetUp();
  }
}

TEST_F(FaultyStreams, StampsThatGoBackForAWhileMoveNoOther) {
  for (const std::int64_t back : {1'332LL, 100'000LL, 1'000'000LL}) {
    const auto truth = undisturbed();
    for (int i = 1000; i < 1200; ++i) set_stamp(point_packet(i), stamp(point_packet(i)) - back);
    Bench bench;
    feed(bench);
    EXPECT_GE(bench.points.size(), kPackets - 220U) << back << "\n" << counters_of(bench);
    expect_the_same(bench, truth);
    SetUp();
  }
}

TEST_F(FaultyStreams, MidnightAndTheNewYearPassUnnoticed) {
  const auto truth = undisturbed();
  const std::int64_t new_year = 1'514'764'800'000'000;  // us, 2018-01-01
  const std::int64_t by = new_year - stamp(point_packet(1500));
  for (int i = 0; i < kPackets; ++i) set_stamp(point_packet(i), stamp(point_packet(i)) + by);
  Bench bench;
  feed(bench);
  EXPECT_EQ(bench.points.size(), static_cast<std::size_t>(kPackets)) << counters_of(bench);
  EXPECT_EQ(bench.count("clock.jumps"), 0);
  expect_the_same(bench, truth);
}

TEST_F(FaultyStreams, ALeapSecondThatTheDeviceRepeatsIsFollowed) {
  const auto truth = undisturbed();
  for (int i = 1000; i < kPackets; ++i) set_stamp(point_packet(i), stamp(point_packet(i)) - 1'000'000);
  Bench bench;
  feed(bench);
  EXPECT_EQ(bench.points.size(), kPackets - 9U) << counters_of(bench);
  EXPECT_EQ(bench.count("clock.jumps"), 1);
  expect_the_same(bench, truth);
}

TEST_F(FaultyStreams, StampsThatAreNoTimeCostTheirPacketsAtMost) {
  const auto truth = undisturbed();
  std::mt19937 random(3);
  for (int i = 100; i < 2900; i += 100)
    for (std::size_t byte = 20; byte < 30; ++byte) point_packet(i).bytes[byte] = static_cast<std::uint8_t>(random());
  Bench bench;
  feed(bench);
  EXPECT_GE(bench.points.size(), kPackets - 28U) << counters_of(bench);
  expect_the_same(bench, truth);
}

}  // namespace
}  // namespace curbstone::lidar
