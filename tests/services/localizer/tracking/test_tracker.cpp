#include "services/localizer/tracking/tracker.hpp"

#include <gtest/gtest.h>

#include "tests/services/localizer/yard.hpp"

namespace curbstone::localizer::tracking {
namespace {

using test_yard::map_of;
using test_yard::points_in;
using test_yard::pose_at;
using test_yard::Yard;

PoseBelief start(const Pose& pose) {
  Vector6 sigma;
  sigma << 0.15, 0.15, 0.1, 0.02, 0.02, 0.03;
  return {pose, sigma.cwiseAbs2().asDiagonal()};
}

/// 0.1 m a revolution along x of the vehicle.
Motion ahead() {
  Motion motion;
  motion.T_last_base.translation().x() = 0.1;
  motion.seconds = 0.05;
  return motion;
}

TEST(Tracker, FollowsADriveAndIsSureAfterHalfASecond) {
  const Yard yard;
  fields::SavedMap map(map_of(yard));
  Pose truth = pose_at(-3, 0, 0.2);
  Tracker tracker(start(truth), {});
  for (int i = 0; i < 60; ++i) {
    truth = truth * ahead().T_last_base;
    tracker.track({points_in(yard, truth)}, ahead(), map);
    EXPECT_EQ(tracker.lost(), i + 1 < Tracker::kConfirmations) << i;
    EXPECT_LT(error_between(truth, tracker.belief().T_map_base).head<2>().norm(), 0.03) << i;
  }
}

TEST(Tracker, LookingOnFromOnePlaceMakesThePoseNoSurer) {
  const Yard yard;
  fields::SavedMap map(map_of(yard));
  Pose truth = pose_at(-3, 0, 0.2);
  Tracker tracker(start(truth), {});
  for (int i = 0; i < 40; ++i) {
    truth = truth * ahead().T_last_base;
    tracker.track({points_in(yard, truth)}, ahead(), map);
  }
  const Matrix6 driving = tracker.belief().covariance;
  Motion standing;
  standing.seconds = 0.05;
  for (int i = 0; i < 200; ++i) tracker.track({points_in(yard, truth)}, standing, map);
  const double ratio = tracker.belief().covariance(0, 0) / driving(0, 0);
  EXPECT_GT(ratio, 0.5);
  EXPECT_LT(ratio, 1.5);
  EXPECT_FALSE(tracker.lost());
}

TEST(Tracker, CreepingWithNothingBesideItIsKnownWorseAndWorse) {
  const Yard yard;
  fields::SavedMap map(map_of(yard));
  Pose truth = pose_at(-3, 0, 0.2);
  TrackingConfig config;
  config.use_walls = false;
  config.heights = Heights::kNone;
  Tracker tracker(start(truth), config);
  Motion creeping;
  creeping.T_last_base.translation().x() = 0.01;  // far less than a cell
  creeping.seconds = 0.05;
  tracker.track({points_in(yard, truth)}, creeping, map);
  const double before = tracker.belief().covariance(0, 0);
  for (int i = 0; i < 300; ++i) {
    truth = truth * creeping.T_last_base;
    tracker.track({points_in(yard, truth)}, creeping, map);
  }
  const double floor = config.odometry_floor_m;
  EXPECT_GT(tracker.belief().covariance(0, 0), before + 300 * floor * floor);
}

TEST(Tracker, SeenAgainAfterItWasBlindItIsKnownThoughItStands) {
  const Yard yard;
  fields::SavedMap map(map_of(yard));
  const Pose truth = pose_at(-3, 0, 0.2);
  Tracker tracker(start(truth), {});
  Motion standing;
  standing.seconds = 0.05;
  for (int i = 0; i < 20; ++i) tracker.track({points_in(yard, truth)}, standing, map);
  Motion blind = standing;
  blind.with_odometry = false;
  for (int i = 0; i < 5; ++i) tracker.track({}, blind, map);
  EXPECT_GT(tracker.belief().covariance(0, 0), 1e-3);
  for (int i = 0; i < 3; ++i) tracker.track({points_in(yard, truth)}, standing, map);
  EXPECT_LT(tracker.belief().covariance(0, 0), 1e-3);
}

TEST(Tracker, IsFoundByABetterFitThanItIsHeldBy) {
  const Yard yard;
  fields::SavedMap map(map_of(yard));
  const Pose truth = pose_at(-3, 0, 0.2);
  const auto points = points_in(yard, truth);
  const double share = Tracker(start(truth), {}).track({points}, Motion{}, map).matched_share();
  ASSERT_GT(share, 0.6);
  TrackingConfig config;
  config.min_match = share - 0.01;
  config.find_match = share + 0.01;
  Tracker doubting(start(truth), config);
  for (int i = 0; i < 100; ++i) doubting.track({points}, Motion{}, map);
  EXPECT_TRUE(doubting.lost());
  config.find_match = share - 0.01;
  Tracker believing(start(truth), config);
  for (int i = 0; i < 20; ++i) believing.track({points}, Motion{}, map);
  EXPECT_FALSE(believing.lost());
}

TEST(Tracker, StartedMetresOffIsNeverSureOfAWrongPlaceAndFindsTheRightOne) {
  const Yard yard;
  for (const Eigen::Vector2d& off : {Eigen::Vector2d(1, 0), {-2.5, 0}, {0, 1.3}, {2, -1}}) {
    fields::SavedMap map(map_of(yard));
    Pose truth = pose_at(-3, 0, 0.2);
    Pose wrong = truth;
    wrong.translation() += truth.linear() * Eigen::Vector3d(off.x(), off.y(), 0);
    Tracker tracker(start(wrong), {});
    for (int i = 0; i < 60; ++i) {
      truth = truth * ahead().T_last_base;
      tracker.track({points_in(yard, truth)}, ahead(), map);
      const double error = error_between(truth, tracker.belief().T_map_base).head<2>().norm();
      EXPECT_TRUE(tracker.lost() || error < 0.1) << off.transpose() << ": " << error << " m at " << i;
    }
    EXPECT_FALSE(tracker.lost()) << off.transpose();
  }
}

TEST(Tracker, OnAMapOfAnotherPlaceIsNeverSure) {
  const Yard here, other{.half_length = 8.3, .half_width = 9.4, .turned = -0.5, .curb = 2};
  fields::SavedMap map(map_of(other));
  Pose truth = pose_at(-3, 0, 0.2);
  Tracker tracker(start(truth), {});
  for (int i = 0; i < 100; ++i) {
    truth = truth * ahead().T_last_base;
    tracker.track({points_in(here, truth)}, ahead(), map);
    EXPECT_TRUE(tracker.lost()) << i;
  }
}

TEST(Tracker, CarriedAwaySaysSoWithinASecondAndGoesOnWithOdometry) {
  const Yard yard;
  fields::SavedMap map(map_of(yard));
  Pose truth = pose_at(-3, 0, 0.2);
  Tracker tracker(start(truth), {});
  for (int i = 0; i < 20; ++i) tracker.track({points_in(yard, truth)}, Motion{}, map);
  ASSERT_FALSE(tracker.lost());
  truth = pose_at(3, 2, 1.4);
  for (int i = 0; i < 20; ++i) tracker.track({points_in(yard, truth)}, Motion{}, map);
  EXPECT_TRUE(tracker.lost());
  const double sigma = std::sqrt(tracker.published_covariance()(0, 0));
  for (int i = 0; i < 20; ++i) tracker.track({points_in(yard, truth)}, ahead(), map);
  EXPECT_TRUE(tracker.lost());
  EXPECT_GT(std::sqrt(tracker.published_covariance()(0, 0)), sigma) << "known worse and worse";
}

TEST(Tracker, WhereNothingStandsTheGroundHoldsAPoseThatIsKnownAndFindsNone) {
  const Yard yard;
  fields::SavedMap map(map_of(yard));
  Pose truth = pose_at(-3, 0, 0.2);
  const auto ground_at = [&](const Pose& pose) {
    auto points = points_in(yard, pose);
    std::erase_if(points, [](const Eigen::Vector3d& p) { return p.z() > 0.4; });
    return points;
  };
  Tracker known(start(truth), {}), unknown(start(truth), {});
  for (int i = 0; i < 20; ++i) known.track({points_in(yard, truth)}, Motion{}, map);
  for (int i = 0; i < 40; ++i) {
    truth = truth * ahead().T_last_base;
    known.track({ground_at(truth)}, ahead(), map);
    EXPECT_FALSE(known.lost()) << i;
    unknown.track({ground_at(truth)}, ahead(), map);
    EXPECT_TRUE(unknown.lost()) << i;
  }
  EXPECT_LT(error_between(truth, known.belief().T_map_base).head<2>().norm(), 0.1);
}

TEST(Tracker, OnALongStreetWithoutWallsIsLostLengthwiseAndStaysBesideItsCurb) {
  const Yard yard{.half_length = 120, .turned = 0, .ends = false};
  fields::SavedMap map(map_of(yard));
  Pose truth = pose_at(-90, 0, 0);
  const auto near = [&](const Pose& pose, bool with_walls) {
    auto points = points_in(yard, pose);
    std::erase_if(points,
                  [&](const Eigen::Vector3d& p) { return p.head<2>().norm() > 15 || (!with_walls && p.z() > 0.4); });
    return points;
  };
  Tracker tracker(start(truth), {});
  Motion motion = ahead();
  motion.T_last_base.translation() << 1.0, 0.005, 0;  // odometry drifts aside
  const Pose real = pose_at(1.0, 0, 0);
  for (int i = 0; i < 20; ++i) tracker.track({near(truth, true)}, Motion{}, map);
  ASSERT_FALSE(tracker.lost());
  for (int i = 0; i < 150; ++i) {
    truth = truth * real;
    tracker.track({near(truth, false)}, motion, map);
    EXPECT_NEAR(tracker.belief().T_map_base.translation().y(), 0, 0.08) << i << ": a part of a cell";
  }
  EXPECT_TRUE(tracker.lost()) << "150 m by odometry alone";
  EXPECT_GT(std::sqrt(tracker.published_covariance()(0, 0)), 0.2);
}

TEST(Tracker, AtTheEndOfAStreetThatTellsNothingLengthwiseMustFitForLongAgain) {
  const Yard yard{.half_length = 40, .turned = 0};
  fields::SavedMap map(map_of(yard));
  const auto walls_near = [&](const Pose& pose) {  // without the pillars
    auto points = points_in(yard, pose);
    std::erase_if(points, [&](const Eigen::Vector3d& p) {
      const Eigen::Vector3d q = pose * p;
      return p.head<2>().norm() > 15 || (p.z() > 0.4 && std::abs(q.y()) < 6.5 && std::abs(q.x()) < 39.5);
    });
    return points;
  };
  Pose truth = pose_at(-24, 0, 0);
  Tracker tracker(start(truth), {});
  for (int i = 0; i < 20; ++i) tracker.track({walls_near(truth)}, Motion{}, map);
  ASSERT_FALSE(tracker.lost());
  Motion motion = ahead();
  motion.T_last_base = pose_at(1, 0, 0);
  for (int i = 0; i < 48; ++i) {
    truth = truth * motion.T_last_base;
    tracker.track({walls_near(truth)}, motion, map);
  }
  ASSERT_TRUE(tracker.lost()) << "48 m between two walls";
  truth = truth * pose_at(3, 0, 0);
  motion.T_last_base = pose_at(3, 0, 0);
  int revolutions = 0;
  for (; revolutions < 60 && tracker.lost(); ++revolutions) {
    tracker.track({walls_near(truth)}, motion, map);
    motion = Motion{};
  }
  EXPECT_FALSE(tracker.lost()) << "the wall across is in sight";
  EXPECT_GE(revolutions, Tracker::kReconfirmations);
}

TEST(Tracker, SaysThatAMapWhichLittleHeldIsBentHoweverLongItLooks) {
  const Yard yard;
  fields::SavedMap map(map_of(yard));
  TrackingConfig level;
  level.use_walls = false;
  level.heights = Heights::kNone;
  const auto sigma = [&](const TrackingConfig& config) {
    Pose truth = pose_at(-3, 0, 0.2);
    PoseBelief known = start(truth);
    known.covariance *= 1e-6;
    Tracker tracker(known, config);
    for (int i = 0; i < 60; ++i) {
      truth = truth * ahead().T_last_base;
      tracker.track({points_in(yard, truth)}, ahead(), map);
    }
    return std::sqrt(tracker.published_covariance()(0, 0));
  };
  const TrackingConfig all;
  EXPECT_LT(sigma(all), 0.03) << "four walls held the mapper";
  EXPECT_GT(sigma(level), all.map_drift_m) << "nothing did";
}

TEST(Tracker, AGapInOdometryIsSurvived) {
  const Yard yard;
  fields::SavedMap map(map_of(yard));
  const Pose truth = pose_at(-1, 0, 0.2);
  Tracker tracker(start(truth), {});
  for (int i = 0; i < 20; ++i) tracker.track({points_in(yard, truth)}, Motion{}, map);
  Motion blind;
  blind.with_odometry = false;
  blind.seconds = 3;
  tracker.track({points_in(yard, truth)}, blind, map);
  for (int i = 0; i < Tracker::kReconfirmations; ++i) tracker.track({points_in(yard, truth)}, Motion{}, map);
  EXPECT_FALSE(tracker.lost());
  EXPECT_LT(error_between(truth, tracker.belief().T_map_base).head<2>().norm(), 0.03);
}

}  // namespace
}  // namespace curbstone::localizer::tracking
