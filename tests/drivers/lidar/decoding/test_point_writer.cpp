// The points against the manual's formulas, written out shot by shot.
#include "drivers/lidar/decoding/point_writer.hpp"

#include <gmock/gmock.h>

#include <random>

#include "drivers/lidar/decoding/direction.hpp"

namespace curbstone::lidar::decoding {
namespace {

constexpr double kStep = 0.0025;  // m
constexpr double kLens = 0.035;

ShotTable helios_like_table() {
  ShotTable shots;
  for (std::size_t i = 0; i < kRecordsPerBlock; ++i) {
    const auto n = static_cast<double>(i);
    shots.set(i, 1.73e-6 * n, {14.9 - 2.1 * n, 0.5 * n - 7, 0.001 * n, static_cast<std::uint8_t>(31 - i)});
  }
  return shots;
}

std::shared_ptr<const PointRules> rules_of(const ReturnLimits& limits, const DistanceUnit& unit, double lens = 0) {
  return std::make_shared<PointRules>(PointRules{limits, unit, lens, helios_like_table()});
}

struct Expected {
  std::vector<double> x, y, z, time;
  std::vector<std::uint8_t> intensity, ring;
  int none = 0, out_of_range = 0;
};

/// One shot as rs16.md and the manuals have it: the lens stands beside the axis, the laser looks beside the head.
void add_shot(Expected& expected, const ReturnLimits& limits, const BlockPlace& place, std::size_t i,
              const BlockRecords& records) {
  if (records.distance[i] == 0 || records.distance[i] == 0xFFFF) {
    ++expected.none;
    return;
  }
  const auto n = static_cast<double>(i);
  const double range = records.distance[i] * kStep;
  const double time = 1.73e-6 * n;
  const double head = 0.01 * place.azimuth + place.turned_a_second * time;
  const double beam = head + 0.5 * n - 7;
  const double elevation = (14.9 - 2.1 * n) * kDegree;
  if (range < limits.min_range || range > limits.max_range) {
    ++expected.out_of_range;
    return;
  }
  const double from_start = std::fmod(beam - limits.start_angle + 720, 360);
  const double width = std::fmod(limits.end_angle - limits.start_angle + 720, 360);
  if (width != 0 && from_start >= width) return;
  expected.x.push_back(range * std::cos(elevation) * std::cos(beam * kDegree) + kLens * std::cos(head * kDegree));
  expected.y.push_back(-range * std::cos(elevation) * std::sin(beam * kDegree) - kLens * std::sin(head * kDegree));
  expected.z.push_back(range * std::sin(elevation) + 0.001 * n);
  expected.time.push_back(place.start + time);
  expected.intensity.push_back(records.intensity[i]);
  expected.ring.push_back(static_cast<std::uint8_t>(31 - i));
}

class PointWriterTest : public ::testing::Test {
 protected:
  BlockRecords random_block() {
    BlockRecords records;
    for (std::size_t i = 0; i < kRecordsPerBlock; ++i) {
      const auto kind = random_() % 8;
      records.distance[i] = kind == 0 ? 0 : kind == 1 ? 0xFFFF : static_cast<std::uint16_t>(random_() % 0x10000);
      records.intensity[i] = static_cast<std::uint8_t>(random_());
    }
    return records;
  }
  /// Bit for bit.
  static void expect_the_same_again(const DecodedPacket& packet) {
    DecodedPacket again;
    make_points(packet.fired, again);
    EXPECT_EQ(again.x, packet.x);
    EXPECT_EQ(again.y, packet.y);
    EXPECT_EQ(again.z, packet.z);
    EXPECT_EQ(again.time_offset, packet.time_offset);
    EXPECT_EQ(again.intensity, packet.intensity);
    EXPECT_EQ(again.ring, packet.ring);
    EXPECT_EQ(again.no_return, packet.no_return);
  }
  /// A packet of `returns` blocks at each place, against the formulas.
  void expect_packets(const ReturnLimits& limits, std::size_t returns) {
    DecodedPacket packet;
    for (int i = 0; i < 50; ++i) {
      packet.begin();
      Expected expected;
      PointWriter writer(rules_of(limits, {kStep, 0xFFFF}, kLens), packet);
      for (std::size_t block = 0; block < 12 / returns; ++block) {
        const BlockPlace place = {static_cast<int>(random_() % 36000), 7200.0, 1e-4 * static_cast<double>(block)};
        std::vector<BlockRecords> records;
        for (std::size_t r = 0; r < returns; ++r) records.push_back(random_block());
        for (std::size_t shot = 0; shot < kRecordsPerBlock; ++shot) {
          for (const BlockRecords& of : records) add_shot(expected, limits, place, shot, of);
        }
        writer.add(place, records);
      }
      writer.finish();
      ASSERT_EQ(packet.x.size(), expected.x.size());
      for (std::size_t p = 0; p < packet.x.size(); ++p) {
        // Half a bit of a float at this distance.
        ASSERT_FLOAT_EQ(packet.x[p], static_cast<float>(expected.x[p])) << p;
        ASSERT_NEAR(static_cast<double>(packet.x[p]), expected.x[p], 8e-6) << p;
        ASSERT_NEAR(static_cast<double>(packet.y[p]), expected.y[p], 8e-6) << p;
        ASSERT_NEAR(static_cast<double>(packet.z[p]), expected.z[p], 8e-6) << p;
        ASSERT_FLOAT_EQ(packet.time_offset[p], static_cast<float>(expected.time[p])) << p;
      }
      EXPECT_EQ(packet.intensity, expected.intensity);
      EXPECT_EQ(packet.ring, expected.ring);
      EXPECT_EQ(packet.no_return, expected.none);
      EXPECT_EQ(packet.out_of_range, expected.out_of_range);
      expect_the_same_again(packet);
    }
  }
  std::mt19937 random_{7};
};

TEST_F(PointWriterTest, PutsEachReturnWhereTheManualDoes) {
  expect_packets({.min_range = 0.4, .max_range = 150}, 1);
}

TEST_F(PointWriterTest, PutsBothReturnsOfAShotBesideEachOther) {
  expect_packets({.min_range = 0.4, .max_range = 150}, 2);
}

TEST_F(PointWriterTest, LeavesOutWhatIsNotInTheSector) {
  expect_packets({.min_range = 0.4, .max_range = 150, .start_angle = 300, .end_angle = 40}, 1);
  expect_packets({.min_range = 0.4, .max_range = 150, .start_angle = 90, .end_angle = 180}, 2);
}

TEST_F(PointWriterTest, TakesTheLimitsThemselvesIn) {
  DecodedPacket packet;
  packet.begin();
  // 0.4 m are 160 steps, and as a double a little more; the product decides, as it did for each return.
  PointWriter writer(rules_of({.min_range = 160 * kStep, .max_range = 4000 * kStep}, {kStep, 0xFFFF}), packet);
  BlockRecords records;
  records.distance[0] = 159;
  records.distance[1] = 160;
  records.distance[2] = 4000;
  records.distance[3] = 4001;
  writer.add({}, records);
  writer.finish();
  EXPECT_THAT(packet.ring, ::testing::ElementsAre(30, 29));
  EXPECT_EQ(packet.out_of_range, 2);
  EXPECT_EQ(packet.no_return, 28);
}

TEST_F(PointWriterTest, TakesEverythingWithoutLimits) {
  DecodedPacket packet;
  packet.begin();
  PointWriter writer(rules_of({.min_range = 0, .max_range = 400}, {kStep, 0}), packet);
  BlockRecords records;
  records.distance.fill(0xFFFF);
  records.distance[5] = 1;
  records.leave_out(6);
  writer.add({}, records);
  writer.finish();
  EXPECT_EQ(packet.x.size(), 31U);
  EXPECT_EQ(packet.no_return, 0) << "the one left out repeats another";
}

TEST(DirectionOf, IsThatOfTheLibraryForEveryAzimuth) {
  for (int azimuth = 0; azimuth < 36000; ++azimuth) {
    ASSERT_EQ(direction_of(azimuth).cos, std::cos(0.01 * azimuth * kDegree)) << azimuth;
    ASSERT_EQ(direction_of(azimuth).sin, std::sin(0.01 * azimuth * kDegree)) << azimuth;
  }
}

TEST(Compact, KeepsTheOrderForEverySetOfEight) {
  for (unsigned set = 0; set < 256; ++set) {
    std::array<std::uint8_t, 8> keep{};
    std::array<std::int32_t, 8> from{};
    std::array<std::int32_t, 16> to{};
    std::vector<std::int32_t> expected;
    for (unsigned i = 0; i < 8; ++i) {
      from[i] = static_cast<std::int32_t>(1000 * set + i);
      keep[i] = set >> i & 1;
      if (keep[i] != 0) expected.push_back(from[i]);
    }
    const Column column{from.data(), to.data()};
    ASSERT_EQ(compact(keep, {&column, 1}), expected.size());
    ASSERT_TRUE(std::equal(expected.begin(), expected.end(), to.begin())) << set;
  }
}

}  // namespace
}  // namespace curbstone::lidar::decoding
