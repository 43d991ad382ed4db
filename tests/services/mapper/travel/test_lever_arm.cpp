#include "services/mapper/travel/lever_arm.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

namespace curbstone::mapper::travel {
namespace {

/// A vehicle whose map takes for base_link what is `excess_` behind it, as vehicle.lidar has the LiDAR so much too far
/// ahead and to the left.
class LeverArmTest : public ::testing::Test {
 protected:
  /// On for `seconds` at `speed` m/s and `turn` rad/s.
  void drive(double seconds, double speed, double turn) {
    constexpr double kPeriod = 0.1;  // s
    const auto move = [&](double dt) {
      const double half = turn * dt / 2;  // the chord of the arc
      const double chord = std::abs(half) > 1e-9 ? speed * dt * std::sin(half) / half : speed * dt;
      return pose(chord * std::cos(half), chord * std::sin(half), 2 * half);
    };
    for (const double end = t_ + seconds; t_ < end - 1e-9; t_ += kPeriod) {
      T_world_base_ = T_world_base_ * move(kPeriod);
      const Pose T_map_base = T_world_base_ * move(-lag_) * pose(0, 0, -yaw_) * pose(-excess_.x(), -excess_.y(), 0);
      Pose T_odom_base = T_world_base_;
      T_odom_base.translation() *= length_;
      arm_.add(std::llround(1e6 * t_), T_map_base, T_odom_base);
    }
  }
  /// `bends` of a right angle to either side, at 3 m/s.
  void drive_bends(int bends) {
    for (int i = 0; i < bends; ++i) {
      for (const double turn : {0.4, -0.4}) {
        drive(3, 3, 0);
        drive(4, 3, turn);
      }
    }
    drive(3, 3, 0);
  }
  static Pose pose(double x, double y, double yaw) {
    Pose p = Pose::Identity();
    p.translation() = Eigen::Vector3d(x, y, 0);
    p.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    return p;
  }
  /// What the straight stretches say.
  [[nodiscard]] TravelDirection::Straight straight() const { return {yaw_, length_ - 1}; }
  void expect(const std::optional<LeverArm::Excess>& found) const {
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->by.x(), excess_.x(), 0.02);
    EXPECT_NEAR(found->by.y(), excess_.y(), 0.02);
  }

  LeverArm arm_;
  Eigen::Vector2d excess_{0.4, -0.3};
  double yaw_ = 0, length_ = 1, lag_ = 0;
  double t_ = 100;
  Pose T_world_base_ = Pose::Identity();
};

TEST_F(LeverArmTest, IsFoundInBendsToBothSides) {
  drive_bends(2);
  expect(arm_.excess({}));
}

TEST_F(LeverArmTest, IsFoundAfterThreeBendsToOneSide) {
  drive(20, 3, 0);
  EXPECT_FALSE(arm_.excess({})) << "nothing shows on a straight road";
  drive(3.5, 3, 0.4);
  EXPECT_FALSE(arm_.excess({}));
  drive(1, 3, 0.4);
  expect(arm_.excess({}));
  EXPECT_EQ(arm_.excess({})->bends, 3);
}

TEST_F(LeverArmTest, WheelsOfAnotherSizeAndAYawAreTakenOut) {
  yaw_ = 0.03;
  length_ = 1.04;
  drive_bends(2);
  expect(arm_.excess(straight()));
  EXPECT_FALSE(arm_.excess({})) << "left and right do not agree";
}

TEST_F(LeverArmTest, LateStampsAreNotTakenForAnotherPlace) {
  excess_.setZero();
  lag_ = 0.08;
  drive_bends(3);
  const auto found = arm_.excess({});
  ASSERT_TRUE(found);
  EXPECT_LT(found->by.norm(), 0.05);
}

TEST_F(LeverArmTest, IsFoundTurningOnTheSpotAndInReverse) {
  for (const double turn : {0.3, -0.3}) {
    drive(6, 0, turn);
    drive(6, -1, turn);
  }
  expect(arm_.excess({}));
}

TEST_F(LeverArmTest, FastBendsAreLeftOut) {
  for (int i = 0; i < 4; ++i) {
    drive(6, 6, 0.3);
    drive(6, 6, -0.3);
  }
  EXPECT_FALSE(arm_.excess({}));
}

TEST_F(LeverArmTest, ABendThatIsInterruptedIsNotUsed) {
  for (int i = 0; i < 30; ++i) {
    drive(1.2, 3, i % 6 < 3 ? 0.4 : -0.4);
    arm_.interrupt();
  }
  EXPECT_FALSE(arm_.excess({}));
}

}  // namespace
}  // namespace curbstone::mapper::travel
