// A real RS-LiDAR-16's packets (washing_house) with faults put in: what is bad costs itself and nothing else.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "tests/drivers/lidar/faulty_packets.hpp"
#include "tests/drivers/lidar/packets.hpp"

namespace curbstone::lidar {
namespace {

using testing::Contains;
using ::testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

TEST_F(FaultyPackets, AnUndisturbedRecordingIsWholeAndWithoutRefusals) {
  Bench bench;
  feed(bench);
  EXPECT_EQ(bench.points.size(), static_cast<std::size_t>(kPackets));
  EXPECT_EQ(bench.refused(), 0);
  EXPECT_EQ(bench.count("lost.packets"), 0);
}

TEST_F(FaultyPackets, ADamagedAzimuthCostsItsPacketAndMovesNoStamp) {
  const auto truth = undisturbed();
  for (const std::size_t block : {0U, 5U, 11U}) {
    for (const int off : {9000, -9000, 18000, 200}) {
      const RecordedPacket good = point_packet(1500);
      turn_azimuth(point_packet(1500), block, off);
      Bench bench;
      feed(bench);
      EXPECT_EQ(bench.points.size(), kPackets - 1U) << off << " in block " << block;
      EXPECT_EQ(bench.count("refused.azimuth"), 1);
      EXPECT_EQ(bench.refused(), 1);
      EXPECT_EQ(bench.count("lost.packets"), 0) << "it was not lost, it was damaged";
      expect_the_same(bench, truth);
      point_packet(1500) = good;
    }
  }
}

TEST_F(FaultyPackets, ThirteenDamagedAzimuthsOfThreeThousandLoseThirteen) {
  const auto truth = undisturbed();
  for (int i = 0; i < 13; ++i) turn_azimuth(point_packet(100 + 225 * i), 0, 9000);  // each third turn at the same place
  Bench bench;
  feed(bench);
  EXPECT_EQ(bench.points.size(), kPackets - 13U);
  EXPECT_EQ(bench.count("refused.azimuth"), 13);
  EXPECT_EQ(bench.refused(), 13);
  EXPECT_EQ(bench.count("lost.packets"), 0);
  expect_the_same(bench, truth);
}

TEST_F(FaultyPackets, APacketThatIsTurnedAsAWholeIsRefusedToo) {
  const auto truth = undisturbed();
  for (std::size_t block = 0; block < 12; ++block) turn_azimuth(point_packet(1500), block, 9000);
  Bench bench;
  feed(bench);
  EXPECT_EQ(bench.points.size(), kPackets - 1U);
  EXPECT_EQ(bench.count("refused.azimuth"), 1);
  expect_the_same(bench, truth);
}

TEST_F(FaultyPackets, WrongStampsAreRefusedAndNoneIsPublished) {
  for (const bool set : {true, false}) {  // the device's clock: set to the host's; or as recorded, in 2017
    if (set) set_device_clock(0);
    const auto truth = undisturbed();
    const auto good = packets_;
    for (const std::int64_t off : {2'000'000LL, -2'000'000LL, 3'600'000'000LL, -3'600'000'000LL, 86'400'000'000LL,
                                   -86'400'000'000LL, 300'000LL, -50'000LL}) {
      std::mt19937 random(static_cast<std::mt19937::result_type>(off));
      for (int i = 0; i < 30; ++i) {
        RecordedPacket& packet = point_packet(100 * i + static_cast<int>(random() % 99));
        set_stamp(packet, stamp(packet) + off);
      }
      Bench bench;
      feed(bench);
      EXPECT_EQ(bench.points.size(), kPackets - 30U) << off;
      EXPECT_EQ(bench.count("refused.stamp"), 30) << off;
      EXPECT_EQ(bench.refused(), 30);
      EXPECT_EQ(bench.count("clock.device"), set ? 1 : 0);
      EXPECT_EQ(bench.count("clock.jumps"), 0);
      expect_the_same(bench, truth);
      packets_ = good;
    }
    SetUp();
  }
}

TEST_F(FaultyPackets, AWrongFirstStampIsNotPublishedEither) {
  set_device_clock(0);
  const auto truth = undisturbed();
  set_stamp(point_packet(0), stamp(point_packet(0)) + 2'000'000);
  Bench bench;
  feed(bench);
  EXPECT_EQ(bench.points.size(), kPackets - 1U);
  EXPECT_EQ(bench.count("refused.stamp"), 1);
  expect_the_same(bench, truth);
}

TEST_F(FaultyPackets, AClockThatIsSetForGoodIsFollowed) {
  set_device_clock(-3'600'000'000);
  for (int i = 1000; i < kPackets; ++i) set_stamp(point_packet(i), stamp(point_packet(i)) + 3'600'000'000);
  Bench bench;
  feed(bench);
  EXPECT_EQ(bench.count("clock.jumps"), 1);
  EXPECT_EQ(bench.count("refused.stamp"), 9) << "until ten in a row agreed";
  EXPECT_EQ(bench.points.size(), kPackets - 9U);
  EXPECT_EQ(bench.count("clock.device"), 1) << "once a second of packets said so";
}

TEST_F(FaultyPackets, SwappedNeighboursArePutInOrder) {
  const auto truth = undisturbed();
  for (const int first : {500, 1000, 1001, 2000}) {
    auto& a = point_packet(first);
    auto& b = point_packet(first + 1);
    std::swap(a.bytes, b.bytes);  // the times of receipt stay in order
  }
  Bench bench;
  feed(bench);
  EXPECT_EQ(bench.points.size(), static_cast<std::size_t>(kPackets));
  EXPECT_EQ(bench.refused(), 0);
  EXPECT_EQ(bench.count("lost.packets"), 0);
  expect_the_same(bench, truth);
  for (std::size_t i = 0; i < bench.points.size(); ++i) ASSERT_EQ(bench.points[i].packet, static_cast<int>(i));
}

TEST_F(FaultyPackets, OneThatComesTooLateIsLateAndNotLostToo) {
  const auto truth = undisturbed();
  auto late = point_packet(1000);
  const auto from = std::ranges::find_if(packets_, [&](const RecordedPacket& p) { return p.bytes == late.bytes; });
  late.received = point_packet(1010).received;
  const auto to = from + 10;
  std::move(from + 1, to, from);
  *(to - 1) = late;
  Bench bench;
  feed(bench);
  EXPECT_EQ(bench.points.size(), kPackets - 1U);
  EXPECT_EQ(bench.count("refused.late"), 1);
  EXPECT_EQ(bench.count("lost.packets"), 0);
  expect_the_same(bench, truth);
}

TEST_F(FaultyPackets, DoubledAndMissingPacketsAreCountedAsSuch) {
  const auto truth = undisturbed();
  std::vector<RecordedPacket> changed;
  int points = 0;
  for (const RecordedPacket& packet : packets_) {
    const bool point = packet.port == models::robosense::kMsopPort;
    if (point && ++points % 100 == 50) continue;
    changed.push_back(packet);
    if (point && points % 100 == 20) changed.push_back(packet);
  }
  packets_ = changed;
  Bench bench;
  feed(bench);
  EXPECT_EQ(bench.points.size(), kPackets - 30U);
  EXPECT_EQ(bench.count("refused.duplicate"), 30);
  EXPECT_EQ(bench.count("lost.packets"), 30);
  EXPECT_EQ(bench.refused(), 30);
  expect_the_same(bench, truth);
}

TEST_F(FaultyPackets, OneDamagedDeviceInformationChangesNothing) {
  const auto truth = undisturbed();
  int infos = 0;
  for (RecordedPacket& packet : packets_) {
    if (packet.port != models::robosense::kDifopPort || ++infos % 4 != 0) continue;
    for (int i = 41; i < 44; ++i) packet.bytes[static_cast<std::size_t>(i)] = 0;  // firmware that counts in cm
    packet.bytes[300] = 0;                                                        // two returns
    packet.bytes[1165 + 2] = static_cast<std::uint8_t>(packet.bytes[1165 + 2] + 100);
    packet.bytes[34] = 0x46;  // fires in half the turn only
  }
  Bench bench;
  feed(bench);
  EXPECT_EQ(bench.points.size(), static_cast<std::size_t>(kPackets));
  EXPECT_EQ(bench.count("difop"), 40);
  expect_the_same(bench, truth);
  for (std::size_t i = 0; i < bench.points.size(); ++i) EXPECT_EQ(bench.points[i].z, truth.at(bench.points[i].utime).z);
}

TEST_F(FaultyPackets, NoReturnIsCountedAsSuchAtAnyRange) {
  LidarConfig config;
  config.min_range = 0;
  config.max_range = 400;
  Bench bench(config);
  feed(bench);
  EXPECT_EQ(bench.count("no_return") + bench.count("points"), 3000 * 384);
  EXPECT_GE(bench.count("no_return"), 88'764) << "0xFFFF";
  for (const lidar_points_t& message : bench.points)
    for (std::size_t i = 0; i < message.x.size(); ++i)
      ASSERT_LT(std::hypot(message.x[i], message.y[i], message.z[i]), 200.0F);
}

TEST_F(FaultyPackets, MoreThanATwentiethRefusedInASecondIsAFaultThatNamesTheCause) {
  for (int i = 0; i < kPackets; i += 10) point_packet(i).bytes[42] = 0;
  Bench bench;
  std::int64_t tick = packets_.front().received;
  for (const RecordedPacket& packet : packets_) {
    for (; tick < packet.received; tick += 20'000) bench.node.tick(tick);
    bench.send(packet.bytes, packet.received, packet.port);
  }
  EXPECT_EQ(bench.count("refused.block"), 300);
  EXPECT_THAT(bench.node.report().faults, Contains(HasSubstr("most of them refused.block")));
  EXPECT_EQ(bench.count("lost.packets"), 0);
}

TEST_F(FaultyPackets, TheDevicesClockCountsOnlyWhereItAgreesWithASynchronisedHost) {
  const auto device_counts = [&](std::int64_t ahead, bool synchronised, double offset = 0) {
    SetUp();
    set_device_clock(ahead);
    LidarConfig config;
    config.time_offset = offset;
    Bench bench(config);
    bench.host_is_synchronised = synchronised;
    feed(bench);
    EXPECT_NEAR(static_cast<double>(bench.count("clock.difference_us")), static_cast<double>(ahead) + offset * 1e6,
                2000);
    EXPECT_EQ(bench.count("clock.host_synchronised"), synchronised ? 1 : 0);
    return bench.count("clock.device") == 1;
  };
  EXPECT_TRUE(device_counts(0, true));
  EXPECT_TRUE(device_counts(-15'000, true));
  EXPECT_FALSE(device_counts(0, false));
  EXPECT_FALSE(device_counts(-25'000, true));
  EXPECT_FALSE(device_counts(700'000, true));
  EXPECT_FALSE(device_counts(-37'000'000, true));
  EXPECT_TRUE(device_counts(-37'000'000, true, 37.0)) << "the user says what it is";
}

TEST_F(FaultyPackets, AClockThatIsWrongByLeapSecondsOrALittleIsNamed) {
  const auto faults = [&](std::int64_t ahead) {
    SetUp();
    set_device_clock(ahead);
    Bench bench;
    feed(bench);
    return bench.node.report().faults;
  };
  EXPECT_THAT(faults(-37'000'000),
              Contains(HasSubstr("behind the host's, as TAI is from UTC: correct its time source, or "
                                 "set time_offset: 37")));
  EXPECT_THAT(faults(37'000'000), Contains(HasSubstr("set time_offset: -37")));
  EXPECT_THAT(faults(700'000), Contains(HasSubstr("ahead of the host's, whose time is used")));
  EXPECT_THAT(faults(0), Not(Contains(HasSubstr("clock"))));
  EXPECT_THAT(faults(-200'000'000'000'000), Not(Contains(HasSubstr("clock")))) << "never set: nothing to mend";
}

TEST(LidarNode, HoldsTwoPacketsAtMost) {
  Bench bench;
  const auto packets = drive_packets(1'700'000'000'000'000, 20);
  std::size_t most = 0;
  for (std::size_t i = 0; i < packets.size(); ++i) {
    if (i == 10) continue;
    bench.send(packets[i], 1'700'000'000'000'000 + static_cast<std::int64_t>(i + 1) * 1332);
    most = std::max(most, i + 1 - (i > 10 ? 1 : 0) - bench.points.size());
  }
  EXPECT_EQ(most, 2U);
  EXPECT_EQ(bench.points.size(), 19U);
}

TEST(LidarNode, ARevolutionIsANumberOfPacketsWhereThatIsSet) {
  LidarConfig config;
  config.split_packets = 7;
  Bench bench(config);
  const auto packets = drive_packets(1'700'000'000'000'000, 50);
  for (std::size_t i = 0; i < packets.size(); ++i) {
    if (i != 20) bench.send(packets[i], 1'700'000'000'000'000 + static_cast<std::int64_t>(i + 1) * 1332);
  }
  bench.finish();
  ASSERT_EQ(bench.points.size(), 49U);
  for (std::size_t i = 0; i < bench.points.size(); ++i) EXPECT_EQ(bench.points[i].revolution, static_cast<int>(i / 7));
}

TEST(LidarNode, SendsWhatItHoldsWhenNothingComesAnyMore) {
  Bench bench;
  const auto packets = drive_packets(1'700'000'000'000'000, 3);
  bench.send(packets[0], 1'700'003'600'000'000);
  EXPECT_THAT(bench.points, IsEmpty()) << "the second tells whether the first is right";
  bench.node.tick(1'700'003'600'020'000);
  bench.node.tick(1'700'003'600'040'000);
  bench.bus.dispatch();
  EXPECT_EQ(bench.points.size(), 1U);
}

TEST(LidarNode, SaysThatTheReceiveBufferIsSmallAndHowToMendIt) {
  Bench bench;
  bench.node.set_receive_buffer(4 << 20, 212'992);
  EXPECT_THAT(bench.node.report().faults, Contains(HasSubstr("sysctl -w net.core.rmem_max=4194304")));
  bench.node.set_receive_buffer(4 << 20, 4 << 20);
  EXPECT_THAT(bench.node.report().faults, IsEmpty());
}

TEST(LidarNode, SaysThatPacketsAreLost) {
  Bench bench;
  const auto packets = drive_packets(1'700'000'000'000'000, 3000);
  for (std::size_t i = 0; i < packets.size(); ++i) {
    const std::int64_t now = 1'700'000'000'000'000 + static_cast<std::int64_t>(i + 1) * 1332;
    bench.node.tick(now);
    if (i < 10 || i % 20 != 0 || i > 1400) bench.send(packets[i], now);
    if (i == 1000) {
      EXPECT_THAT(bench.node.report().faults, Contains(HasSubstr("were lost in a second")));
    }
  }
  EXPECT_THAT(bench.node.report().faults, Not(Contains(HasSubstr("were lost in a second"))));
}

TEST(LidarNode, DoesNotBlameTheNetworkForPacketsThatTheDeviceDidNotSend) {
  Bench bench;
  const auto packets = drive_packets(1'700'000'000'000'000, 5000);
  for (std::size_t i = 0; i < packets.size(); ++i) {
    const std::int64_t now = 1'700'000'000'000'000 + static_cast<std::int64_t>(i + 1) * 1332;
    bench.node.tick(now);
    const bool is_silent = i >= 1000 && i < 2500;
    if (!is_silent) bench.send(packets[i], now);
    EXPECT_THAT(bench.node.report().faults, Not(Contains(HasSubstr("were lost in a second")))) << i;
    if (i == 2400) {
      EXPECT_THAT(bench.node.report().faults, Contains(HasSubstr("no packets for 1.9 s")));
    }
  }
  EXPECT_GT(bench.count("lost.packets"), 1400) << "they are missing all the same";
}

TEST(LidarNode, SaysThatPacketsWereLostWhileItWasStopped) {
  Bench bench;
  const auto packets = drive_packets(1'700'000'000'000'000, 4000);
  bool was_said = false;
  for (std::size_t i = 0; i < packets.size(); ++i) {
    if (i >= 1000 && i < 2500) continue;  // the kernel keeps no more of them
    const std::int64_t now = 1'700'000'000'000'000 + static_cast<std::int64_t>(i + 1) * 1332;
    bench.node.tick(now);
    EXPECT_THAT(bench.node.report().faults, Not(Contains(HasSubstr("no packets")))) << "the device sent: " << i;
    bench.send(packets[i], now);
    for (const std::string& fault : bench.node.report().faults)
      was_said |= fault.find("were lost in a second") != std::string::npos;
  }
  EXPECT_TRUE(was_said);
}

}  // namespace
}  // namespace curbstone::lidar
