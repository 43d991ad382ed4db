#include "services/localizer/tracking/nearby_alternatives.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>

#include "tests/services/localizer/yard.hpp"

namespace curbstone::localizer::tracking {
namespace {

using test_yard::map_of;
using test_yard::points_in;
using test_yard::pose_at;
using test_yard::Yard;

/// A wrong pose that is held, as a street holds it: the prior is trusted more than the points.
PoseFit held_at(const Pose& pose, const std::vector<Eigen::Vector3d>& points, fields::SavedMap& map) {
  return fit_pose({points}, {pose, 1e-8 * Matrix6::Identity()}, map, {});
}

TEST(NearbyAlternatives, HaveNoBetterPlaceThanTheRightOne) {
  const Yard yard;
  fields::SavedMap map(map_of(yard));
  const Pose truth = pose_at(-1, 0, 0.2);
  const auto points = points_in(yard, truth);
  NearbyAlternatives alternatives;
  const PoseFit own = held_at(truth, points, map);
  EXPECT_FALSE(alternatives.all_tried());
  EXPECT_FALSE(alternatives.better_than(own, {points}, 1000, map, {}));
  EXPECT_TRUE(alternatives.all_tried());
  alternatives.restart();
  EXPECT_FALSE(alternatives.all_tried());
}

void expect_the_right_one(std::initializer_list<Eigen::Vector2d> offs) {
  const Yard yard;
  fields::SavedMap map(map_of(yard));
  const Pose truth = pose_at(-1, 0, 0.2);
  const auto points = points_in(yard, truth);
  for (const Eigen::Vector2d& off : offs) {
    Pose wrong = truth;
    wrong.translation() += truth.linear() * Eigen::Vector3d(off.x(), off.y(), 0);
    NearbyAlternatives alternatives;
    const auto better = alternatives.better_than(held_at(wrong, points, map), {points}, 1000, map, {});
    ASSERT_TRUE(better) << off.transpose();
    EXPECT_LT(error_between(truth, better->belief.T_map_base).head<2>().norm(), 0.05) << off.transpose();
  }
}

TEST(NearbyAlternatives, OfAWrongPoseHaveTheRightOne) {
  expect_the_right_one({{2, -1}});
}

TEST(NearbyAlternatives, OfAPoseThatIsWrongAlongOrAcrossHaveTheRightOne) {  // long
  expect_the_right_one({{1, 0}, {-2.5, 0}, {0, 1.3}});
}

TEST(NearbyAlternatives, BetweenTwoLongWallsAreAllAlike) {
  const Yard street{.ends = false};
  fields::SavedMap map(map_of(street));
  const Pose truth = pose_at(0, 0, street.turned);
  const auto points = points_in(street, truth);
  Pose ahead = truth;
  ahead.translation() += truth.linear() * Eigen::Vector3d(1, 0, 0);
  NearbyAlternatives alternatives;
  EXPECT_FALSE(alternatives.better_than(held_at(ahead, points, map), {points}, 1000, map, {}))
      << "nothing tells; it is degenerate, not wrong";
}

TEST(NearbyAlternatives, AreNotGoneToAlongAnAxisThatTheyDoNotTell) {
  const Yard street{.ends = false};
  fields::SavedMap map(map_of(street));
  const Pose truth = pose_at(0, 0, street.turned);
  const auto points = points_in(street, truth);
  TrackingConfig few;  // so few points count that they do not tell the pose along the street
  few.independent = 0.0001;
  PoseFit doubted = held_at(truth, points, map);
  doubted.grounds_matched /= 2;  // as if each place along the street explained more
  NearbyAlternatives alternatives;
  int gone_to = 0;
  while (!alternatives.all_tried()) {
    const auto place = alternatives.better_than(doubted, {points}, 1, map, few);
    if (!place) continue;
    ++gone_to;
    EXPECT_LT(std::abs((truth.inverse() * place->belief.T_map_base).translation().x()), 0.4);
  }
  EXPECT_GT(gone_to, 0) << "the same place";
}

TEST(NearbyAlternatives, WhereHardlyAnythingStandsAreNoReasonToLeave) {
  const Yard yard;
  fields::SavedMap map(map_of(yard));
  const Pose truth = pose_at(-1, 0, 0.2);
  auto points = points_in(yard, truth);
  std::erase_if(points, [](const Eigen::Vector3d& p) { return p.z() > 0.4; });
  for (int i = 0; i < 60; ++i) points.emplace_back(0.5, 6.3 - 0.1 * i, 1.0);  // new, and no wall, but for its end
  PoseFit own = held_at(truth, points, map);
  own.uprights = 30;  // too few to tell whether they match
  own.uprights_matched = 0;
  ASSERT_EQ(own.matched_share(), 0);
  NearbyAlternatives alternatives;
  EXPECT_FALSE(alternatives.better_than(own, {points}, 1000, map, {})) << "all the ground fits";
}

TEST(NearbyAlternatives, AreNotComparedByWhatIsNotToTellThePose) {
  const Yard yard;
  fields::SavedMap map(map_of(yard));
  const Pose truth = pose_at(-1, 0, 0.2);
  const auto points = points_in(yard, truth);
  Pose wrong = truth;
  wrong.translation() += truth.linear() * Eigen::Vector3d(1, 0, 0);
  TrackingConfig by_odometry;
  by_odometry.use_walls = false;
  by_odometry.heights = Heights::kNone;
  NearbyAlternatives alternatives;
  EXPECT_FALSE(alternatives.better_than(held_at(wrong, points, map), {points}, 1000, map, by_odometry));
}

}  // namespace
}  // namespace curbstone::localizer::tracking
