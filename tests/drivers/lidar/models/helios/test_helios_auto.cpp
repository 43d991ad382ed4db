#include <gmock/gmock.h>

#include "tests/drivers/lidar/bench.hpp"
#include "tests/drivers/lidar/models/helios/helios_packets.hpp"

namespace curbstone::lidar::models::helios {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// `model: auto`, and a Helios whose type byte (07) does not say how many lasers it has.
struct AutoBench : Bench {
  AutoBench() : Bench(config_for(ModelName::kAuto)) {}
  /// `period` us after the one before; one of 32 lasers takes half as long.
  void send_points(int count, std::int64_t period = 1333) {
    for (int i = 0; i < count; ++i, ++sent) {
      MsopPacket packet = helios::points(sent * 480 % 36000, 40, now);
      packet.type[0] = 0x07;
      packet.type[1] = packet.type[2] = 0;
      packet.blocks[0].records[0] = {1000, 1};
      now += period;
      send(bytes_of(packet), now);
    }
  }
  void send_info(const Bytes& bytes) { send(bytes, now, robosense::kDifopPort); }
  int sent = 0;
  std::int64_t now = kUtc;
};

/// Of a 16P, damaged so that it has angles for 32 lasers: the bytes behind its table are not 0xFF.
Bytes damaged_to_32() {
  return info(32);
}

TEST(HeliosAuto, OneDamagedInformationDoesNotDecideTheNumberOfLasers) {
  AutoBench bench;
  bench.send_info(damaged_to_32());
  bench.send_points(20);
  EXPECT_THAT(bench.points, IsEmpty());
  EXPECT_EQ(bench.count("undecided"), 21) << "one may be damaged: a second must agree";
  EXPECT_THAT(bench.node.report().faults,
              Contains(HasSubstr("not decided yet; the last packets are from a RoboSense Helios")));
  bench.send_info(info(16));
  bench.send_points(20);
  EXPECT_EQ(bench.count("undecided"), 42) << "two that differ";
  bench.send_info(info(16));
  bench.send_points(20);
  EXPECT_EQ(bench.points.size(), 20U);
  EXPECT_EQ(bench.refused(), 0) << "the two that decided have the angles too";
  EXPECT_EQ(bench.count("device.rpm"), 599);
  for (const lidar_points_t& message : bench.points) EXPECT_EQ(message.num_points, 1);
}

TEST(HeliosAuto, ADamagedInformationBetweenGoodOnesDecidesNothing) {
  AutoBench bench;
  for (int i = 0; i < 3; ++i) {
    bench.send_info(info(16));
    bench.send_info(damaged_to_32());
  }
  bench.send_points(20);
  EXPECT_EQ(bench.count("undecided"), 26);
  for (int i = 0; i < 2; ++i) bench.send_info(info(32));
  bench.send_points(20, 667);
  EXPECT_EQ(bench.count("undecided"), 28) << "now it is a 32";
  EXPECT_EQ(bench.points.size(), 20U);
}

TEST(HeliosAuto, BelievesTheOnlyInformationOfACaptureWhereItIsPlausible) {
  for (const bool damaged : {false, true}) {
    AutoBench bench;
    bench.node.expect_one_info();
    Bytes only = info(16);
    if (damaged) only[470 + 3 * 4] = 0x20;
    bench.send_info(only);
    bench.send_points(20);
    EXPECT_EQ(bench.points.size(), damaged ? 0U : 16U);
    EXPECT_EQ(bench.count("undecided"), damaged ? 21 : 5) << "five point packets decide";
  }
}

}  // namespace
}  // namespace curbstone::lidar::models::helios
