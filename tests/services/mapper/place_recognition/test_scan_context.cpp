#include "services/mapper/place_recognition/scan_context.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "services/mapper/scan/downsample.hpp"
#include "tests/services/mapper/synthetic_world.hpp"

namespace curbstone::mapper::place_recognition {
namespace {

using test::pose;

std::vector<scan::KeyframePoint> scan_at(const test::SyntheticWorld& world, const Pose& T) {
  std::vector<scan::KeyframePoint> out;
  for (const scan::LidarPoint& p : scan::downsample(world.snapshot(T, test::default_lidar()), 0.2, 60)) {
    if (const auto packed = scan::pack(p.position)) out.push_back(*packed);
  }
  return out;
}

/// Nodes 0.. along the street corner of synthetic_world, every 3 m.
struct Street {
  test::SyntheticWorld world = test::street();
  ScanContext index;
  Street() {
    world.noise = 0.02;
    for (int i = 0; i < 20; ++i) index.add(i, scan_at(world, test::pose(-30 + 3 * i, 0, 0, 0, 0, 0)));
  }
};

TEST(ScanContext, FindsTheNodeThatAScanWasTakenAtAndTheHeading) {
  const Street street;
  for (const double yaw : {0.0, 0.8, std::numbers::pi, -1.3}) {
    const auto found = street.index.query(scan_at(street.world, test::pose(-15.5, 0.4, 0, 0.01, -0.01, yaw)), 3);
    ASSERT_EQ(found.size(), 3U);
    EXPECT_NEAR(found[0].node, 5, 1);
    EXPECT_NEAR(std::remainder(found[0].yaw - yaw, 2 * std::numbers::pi), 0, 0.11);
    EXPECT_LE(found[0].distance, found[1].distance);
  }
}

TEST(ScanContext, FindsItFromTheOtherLane) {
  const Street street;
  const auto found = street.index.query(scan_at(street.world, test::pose(6, 3, 0, 0, 0, std::numbers::pi)), 1);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].node, 12, 1);
}

TEST(ScanContext, TheSameScanIsAtNoDistance) {
  const Street street;
  const auto found = street.index.query(scan_at(street.world, test::pose(-30, 0, 0, 0, 0, 0)), 1);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].node, 0);
  EXPECT_NEAR(found[0].distance, 0, 1e-5);
  EXPECT_NEAR(found[0].yaw, 0, 1e-9);
}

TEST(ScanContext, GivesTheSameAnswerTwiceAndNoMoreThanAsked) {
  const Street street;
  const auto scan = scan_at(street.world, test::pose(0, 1, 0, 0, 0, 2));
  const auto first = street.index.query(scan, 7), second = street.index.query(scan, 7);
  ASSERT_EQ(first.size(), 7U);
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].node, second[i].node);
    EXPECT_EQ(first[i].distance, second[i].distance);
  }
  EXPECT_TRUE(street.index.query(scan, 0).empty());
  EXPECT_TRUE(street.index.query(scan, -1).empty());
}

TEST(ScanContext, KnowsNothingOfEmptyScansAndWhenEmpty) {
  ScanContext index;
  EXPECT_TRUE(index.query({{100, 100, 100}}, 5).empty());
  index.add(3, {});
  EXPECT_EQ(index.size(), 1U);
  EXPECT_TRUE(index.query({}, 5).empty());
  index.add(4, scan_at(test::plain(), test::pose(0, 0, 0, 0, 0, 0)));
  EXPECT_TRUE(index.query({}, 5).empty());
  index.clear();
  EXPECT_EQ(index.size(), 0U);
}

}  // namespace
}  // namespace curbstone::mapper::place_recognition
