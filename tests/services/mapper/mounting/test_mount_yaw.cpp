#include "services/mapper/mounting/mount_yaw.hpp"

#include <gmock/gmock.h>

#include <functional>

#include "tests/services/mapper/detection_scans.hpp"

namespace curbstone::mapper::mounting {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using test::kDegree;

/// A vehicle that drives a bend in a street, with a LiDAR whose mount turns.
class MountYawTest : public ::testing::Test {
 protected:
  /// `mount`: degrees to the left, by time. Corrects the points as the tracker does.
  void drive(double seconds, const std::function<double(double)>& mount) {
    for (double end = t_ + seconds; t_ < end - 1e-9; t_ += test::kPeriod) {
      const Pose T_odom_base = truth(t_);
      scans_.trajectory = [this](double) { return truth(t_); };  // no motion within the scan
      scan::Scan scan = scans_.next();
      const double turned = mount(t_) * kDegree - mount_.yaw();  // what the correction leaves
      for (scan::LidarPoint& point : scan.points) {
        const Eigen::Vector3d p = test::default_lidar() * point.position.cast<double>();
        point.position = (Eigen::AngleAxisd(-turned, Eigen::Vector3d::UnitZ()) * p).cast<float>();
      }
      const auto sight = mount_.add({test::utime(t_), &scan.points, T_odom_base, confirmed_});
      ++seen_[static_cast<std::size_t>(sight)];
    }
  }
  [[nodiscard]] Pose truth(double t) const { return test::driving(0) * scan::move({{3, 0, 0}, {0, 0, 0.2}}, t); }
  [[nodiscard]] std::vector<std::string> faults() const {
    std::vector<std::string> faults;
    mount_.add_faults(faults);
    return faults;
  }
  [[nodiscard]] int num(MountYaw::Result sight) const { return seen_[static_cast<std::size_t>(sight)]; }

  test::DetectionScans scans_;
  MountYaw mount_{test::default_lidar().translation()};
  double t_ = 0;
  bool confirmed_ = true;
  std::array<int, 3> seen_{};  // scans by Sight
};

TEST_F(MountYawTest, ALidarThatIsFirmIsNeverInDoubt) {
  drive(10, [](double) { return 0; });
  EXPECT_EQ(num(MountYaw::Result::kStable), 200);
  EXPECT_EQ(mount_.yaw(), 0);
  EXPECT_THAT(faults(), IsEmpty());
}

TEST_F(MountYawTest, AKnockIsCorrectedAndToldOfUntilTheRestart) {
  drive(5, [](double t) { return t < 2 ? 0 : 5; });
  EXPECT_NEAR(mount_.yaw(), 5 * kDegree, 0.15 * kDegree);
  EXPECT_EQ(num(MountYaw::Result::kTurned), 1);
  EXPECT_LE(num(MountYaw::Result::kUncertain), 4) << "scans that are not used";
  EXPECT_THAT(faults(), ElementsAre(HasSubstr("LiDAR: it turned by 5.")));
}

TEST_F(MountYawTest, PlayIsFollowedEachTime) {
  const auto play = [](double t) { return std::fmod(t, 4) < 2 ? 1.5 : -1.5; };
  drive(15.5, play);
  EXPECT_EQ(num(MountYaw::Result::kTurned), 7);
  EXPECT_NEAR(mount_.yaw(), -3 * kDegree, 0.3 * kDegree) << "since the start";
  EXPECT_EQ(mount_.counters()["faults.lidar.turned_in_mount"], 7);
}

TEST_F(MountYawTest, AShakingLidarIsNotUsedUntilItIsStill) {
  drive(2, [](double) { return 0; });
  drive(4, [](double t) { return 2 * std::sin(2 * 3.14159265 * 3 * t); });
  EXPECT_TRUE(mount_.shakes());
  EXPECT_THAT(faults(), ::testing::Contains(HasSubstr("shakes in its mount")));
  const int unused = num(MountYaw::Result::kUncertain);
  EXPECT_GT(unused, 60) << "of 80";
  drive(4, [](double) { return 0; });
  EXPECT_FALSE(mount_.shakes());
  EXPECT_LT(num(MountYaw::Result::kUncertain), unused + 50);
  EXPECT_THAT(faults(), ::testing::Contains(HasSubstr("shook in its mount")));
}

TEST_F(MountYawTest, OneThatShakesFastIsNotTakenForStillNowAndThen) {
  drive(2, [](double) { return 0; });
  drive(2, [](double t) { return std::sin(2 * M_PI * 7 * t); });
  ASSERT_TRUE(mount_.shakes());
  seen_ = {};
  drive(15, [](double t) { return std::sin(2 * M_PI * 7 * t); });
  EXPECT_EQ(num(MountYaw::Result::kUncertain), 300);
}

TEST_F(MountYawTest, WhileNothingMeasuresTheVehiclesTurnOneThatShookIsNotUsedForTenSeconds) {
  drive(2, [](double) { return 0; });
  drive(2, [](double t) { return 1.5 * std::sin(2 * M_PI * 3 * t); });
  ASSERT_TRUE(mount_.shakes());
  EXPECT_EQ(mount_.skip(test::utime(t_ + 9)), MountYaw::Result::kUncertain);
  EXPECT_EQ(mount_.skip(test::utime(t_ + 11)), MountYaw::Result::kStable);
  EXPECT_FALSE(mount_.shakes());
}

TEST_F(MountYawTest, WhatTurnsGraduallyAndSpringsBackIsNotTheMount) {  // two lorries, and then none
  drive(5, [](double t) { return t < 2 ? 0 : t < 3.5 ? (t - 2) * 8.6 : 0; });
  EXPECT_EQ(mount_.yaw(), 0);
  EXPECT_EQ(num(MountYaw::Result::kTurned), 0);
}

TEST_F(MountYawTest, AGyroThatGoesWrongIsNotTheMount) {
  confirmed_ = false;
  drive(2, [](double) { return 0; });
  drive(5, [](double t) { return (t - 2) * 20; });  // 20 deg/s that odometry does not tell of
  EXPECT_EQ(mount_.yaw(), 0);
  EXPECT_FALSE(mount_.shakes());
  EXPECT_LE(num(MountYaw::Result::kUncertain), 12) << "then its scans are used again";
}

TEST_F(MountYawTest, AGapInTheScansIsNotComparedOver) {
  drive(2, [](double) { return 0; });
  t_ += 1;
  drive(2, [](double) { return 6; });
  EXPECT_EQ(mount_.yaw(), 0);
  EXPECT_EQ(num(MountYaw::Result::kStable), 80);
}

}  // namespace
}  // namespace curbstone::mapper::mounting
