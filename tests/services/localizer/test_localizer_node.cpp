#include "services/localizer/localizer_node.hpp"

#include <cmath>

#include "tests/services/localizer/localizer_on_a_yard.hpp"

namespace curbstone::localizer {
namespace {

using test_yard::kRevolution;
using test_yard::kStart;
using test_yard::LocalizerOnAYard;
using test_yard::map_of;
using test_yard::pose_at;
using ::testing::Contains;
using ::testing::HasSubstr;

TEST_F(LocalizerOnAYard, SaysAtEachRevolutionsEndWhereItIsInTheSavedMap) {
  begin();
  odometry_until(30);
  lidar_until(31);
  ASSERT_EQ(poses_.size(), 30U);
  EXPECT_TRUE(poses_.front().flags & map_pose_t::LOST) << "not confirmed yet";
  const map_pose_t& last = poses_.back();
  EXPECT_FALSE(last.flags & map_pose_t::LOST);
  EXPECT_EQ(last.utime, kStart + 29 * kRevolution + 49'000);
  EXPECT_EQ(last.epoch, 7);
  EXPECT_LT(std::hypot(last.map_base_position[0], last.map_base_position[1]), 0.02);
  EXPECT_GT(last.inlier_ratio, 0.95F);
}

TEST_F(LocalizerOnAYard, SaysTheSameHoweverTheChannelsInterleave) {
  begin();
  for (int i = 0; i < 20; ++i) {
    odometry_until(i + 1);
    lidar_until(i + 1);
  }
  const auto in_step = poses_;
  begin_anew();
  odometry_until(3);
  for (int i = 0; i < 20; ++i) {
    lidar_until(i + 1);
    if (i > 3) odometry_until(i - 1);
  }
  odometry_until(20);
  ASSERT_EQ(poses_.size(), in_step.size());
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    for (int k = 0; k < 3; ++k) EXPECT_EQ(poses_[i].map_base_position[k], in_step[i].map_base_position[k]) << i;
    for (int k = 0; k < 36; ++k) EXPECT_EQ(poses_[i].covariance[k], in_step[i].covariance[k]) << i;
    EXPECT_EQ(poses_[i].flags, in_step[i].flags) << i;
  }
}

TEST_F(LocalizerOnAYard, BetweenTwoEndlessWallsItIsLostAlongThemAndSaysSo) {
  yard_ = {.half_length = 150, .turned = 0, .ends = false};
  config_.map = map_file("street.db", map_of(yard_));
  config_.start = {-110, 0, 0};
  begin_ = pose_at(-110, 0, 0);
  step_ = 1.2;
  begin();
  drive_until(180);
  EXPECT_TRUE(lost()) << "200 m by odometry alone";
  EXPECT_THAT(node_->report().faults, Contains(HasSubstr("lost along the street")));
  EXPECT_NEAR(poses_.back().map_base_position[1], 0, 0.1) << "the walls hold it between them";
}

TEST_F(LocalizerOnAYard, WhereTheLidarsClockAloneIsSetBackThePoseGoesOn) {
  step_ = 0.05;
  begin();
  drive_until(60);
  lidar_off_ = -2'000'000;
  drive_until(120);
  EXPECT_FALSE(lost());
  EXPECT_LT(error(), 0.02);
  EXPECT_EQ(poses_.size(), 119U);
  EXPECT_THAT(node_->report().faults, Contains(HasSubstr("LiDAR: its clock was set 2.00 s back")));
}

/// All sensors' stamps leap, and nothing has moved. Odometry's filter drops some samples to be sure of it.
TEST_F(LocalizerOnAYard, WhereTheHostsClockIsSetThePoseGoesOn) {
  for (const std::int64_t dropped : {0, 120'000}) {
    for (const std::int64_t step : {-3'600'000'000LL, -2'000'000LL, 2'000'000LL, 7'200'000'000LL}) {
      step_ = 0.12;
      bend_ = 0.1;
      begin_anew();
      drive_until(50);
      ASSERT_FALSE(lost());
      set_clock(step, dropped);
      drive_until(60);  // odometry's history and the packets wait until the new clock is certain
      for (int until = 61; until < 100; ++until) {
        drive_until(until);
        EXPECT_FALSE(lost()) << until;
        EXPECT_LT(error(), 0.1) << until;
      }
      expect_no_lost_pose(step);
    }
  }
}

/// It is told so: from the stamps alone a step forward looks like a silence.
TEST_F(LocalizerOnAYard, WhereTheHostsClockIsSetWhileItStandsThePoseGoesOn) {
  for (const std::int64_t step : {-2'000'000LL, 2'000'000LL, 7'200'000'000LL}) {
    step_ = 0;
    begin_anew();
    drive_until(50);
    ASSERT_FALSE(lost());
    node_->clock_was_set(step);
    set_clock(step);
    drive_until(100);
    expect_no_lost_pose(step);
    EXPECT_LT(error(), 0.1);
  }
}

/// A silence that is not as long as the step is none the less one.
TEST_F(LocalizerOnAYard, AfterASilenceOfAnotherLengthThanTheStepItIsLost) {
  step_ = 0;
  begin();
  drive_until(50);
  ASSERT_FALSE(lost());
  node_->clock_was_set(1'000'000);
  clock_ += 1'000'000;
  seen_ += 40;
  heard_ = clock_ + seen_ * kRevolution;
  drive_until(seen_ + 3);
  EXPECT_TRUE(lost());
}

/// As a silence of both sensors is, from which nobody knows how far the vehicle has driven.
TEST_F(LocalizerOnAYard, AfterASilenceOfBothSensorsItIsLost) {
  step_ = 0.12;
  begin();
  drive_until(50);
  ASSERT_FALSE(lost());
  seen_ += 40;
  heard_ = clock_ + seen_ * kRevolution;
  drive_until(seen_ + 3);
  EXPECT_TRUE(lost());
}

TEST_F(LocalizerOnAYard, FindsItselfWithNothingKnown) {
  in_an_open_yard();
  begin_ = test_yard::pose_at(-8, -1, 0.2);
  step_ = 0.15;
  begin();
  drive_until(40);
  EXPECT_TRUE(lost());
  EXPECT_THAT(node_->report().faults, Contains(HasSubstr("not found yet")));
  drive_until(100);
  EXPECT_FALSE(lost());
  for (const map_pose_t& pose : poses_) {
    const Pose truth = at(static_cast<double>(pose.utime - kStart) / kRevolution);
    const double off = std::hypot(pose.map_base_position[0] - truth.translation().x(),
                                  pose.map_base_position[1] - truth.translation().y());
    EXPECT_TRUE(pose.flags & map_pose_t::LOST || off < 0.1) << off;
  }
  EXPECT_EQ(poses_.size(), 99U) << "one a revolution, known or not";
  EXPECT_GT(poses_.front().covariance[0], 1e4F) << "nothing is known";
  EXPECT_EQ(node_->report().counters["found_in_whole_map"], 1);
}

TEST_F(LocalizerOnAYard, AtAPlaceThatTheMapHasTwiceItSaysSo) {
  in_an_open_yard();
  config_.map = map_file("twice.db", test_yard::twice(test_yard::map_of(yard_), 40));
  begin_ = test_yard::pose_at(-8, -1, 0.2);
  step_ = 0.15;
  begin();
  drive_until(100);
  bool said = false;
  for (const map_pose_t& pose : poses_) {
    EXPECT_TRUE(pose.flags & map_pose_t::LOST);
    said = said || (pose.flags & map_pose_t::AMBIGUOUS) != 0;
  }
  EXPECT_TRUE(said);
}

TEST_F(LocalizerOnAYard, FindsTheSameLiveAndReplayed) {
  in_an_open_yard();
  begin_ = test_yard::pose_at(-8, -1, 0.2);
  step_ = 0.15;
  begin();
  drive_until(100);
  const auto live = std::exchange(poses_, {});
  heard_ = kStart - 50'000;
  seen_ = 0;
  begin();
  odometry_until(100);  // all that is to come
  lidar_until(100);
  ASSERT_EQ(poses_.size(), live.size());
  for (std::size_t i = 0; i < poses_.size(); ++i) {
    for (int k = 0; k < 3; ++k) EXPECT_EQ(poses_[i].map_base_position[k], live[i].map_base_position[k]) << i;
    EXPECT_EQ(poses_[i].flags, live[i].flags) << i;
  }
}

TEST_F(LocalizerOnAYard, FollowsByParticlesToo) {
  config_.method = Method::kMonteCarlo;
  step_ = 0.1;
  begin();
  drive_until(60);
  EXPECT_LT(error(), 0.2);
  config_.start.clear();
  EXPECT_THROW(begin(), ConfigError);
}

TEST_F(LocalizerOnAYard, RefusesAStartThatIsNoPose) {
  config_.start = {1, 2};
  EXPECT_THROW(begin(), ConfigError);
}

}  // namespace
}  // namespace curbstone::localizer
