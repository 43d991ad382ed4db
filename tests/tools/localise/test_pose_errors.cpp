#include "tools/localise/pose_errors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace curbstone::localise {
namespace {

constexpr std::int64_t kRevolution = 50'000;  // us
constexpr int kRevolutions = 1000;

/// A drive to the left at 4 m/s along a circle of 60 m, `beside` m to the right of it.
evaluate::truth::Trajectory drive(std::int64_t start, double beside) {
  evaluate::truth::Trajectory poses;
  for (int i = 0; i < kRevolutions; ++i) {
    const double angle = 4.0 * i * 0.05 / 60;
    Pose pose = Pose::Identity();
    pose.linear() = Eigen::AngleAxisd(angle + std::numbers::pi / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    pose.translation() = (60 + beside) * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
    poses.push_back({start + i * kRevolution, pose});
  }
  return poses;
}

/// A map in a frame of its own, and a second drive beside the one that made it.
class PoseErrorsTest : public ::testing::Test {
 protected:
  PoseErrorsTest() {
    T_map_world_.linear() = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    T_map_world_.translation() = Eigen::Vector3d(-20, 5, 1);
    std::vector<semantic_map::tile::TrajectoryPose> mapped;
    for (const auto& pose : drive(0, 0)) mapped.push_back({pose.utime, 0, T_map_world_ * pose.pose});
    truth_.emplace(mapped, drive(0, 0), second_);
  }
  /// The second drive's true poses in the map, each with an error along its own axes: forward, left, and of yaw.
  template <class Error>
  std::vector<map_pose_t> poses_with(Error error) const {
    std::vector<map_pose_t> poses;
    for (const auto& [utime, pose] : second_) {
      const Eigen::Vector3d e = error();
      Pose T = T_map_world_ * pose;
      T.translation() += T.linear() * Eigen::Vector3d(e.x(), e.y(), 0);
      T.linear() = T.linear() * Eigen::AngleAxisd(e.z(), Eigen::Vector3d::UnitZ()).toRotationMatrix();
      map_pose_t message{};
      message.utime = utime;
      const Eigen::Quaterniond q(T.linear());
      for (int i = 0; i < 3; ++i) message.map_base_position[i] = T.translation()[i];
      message.map_base_orientation[0] = q.w();
      message.map_base_orientation[1] = q.x();
      message.map_base_orientation[2] = q.y();
      message.map_base_orientation[3] = q.z();
      for (int i = 0; i < 6; ++i) message.covariance[i * 7] = i < 3 ? 0.01F * 0.01F : 0.001F * 0.001F;
      poses.push_back(message);
    }
    return poses;
  }

  Pose T_map_world_ = Pose::Identity();
  evaluate::truth::Trajectory second_ = drive(1'000'000'000, 1.6);
  std::optional<TrueMapPose> truth_;
};

TEST_F(PoseErrorsTest, AreZeroForTheTruth) {
  const PoseErrors errors = errors_of(poses_with([] { return Eigen::Vector3d::Zero(); }), *truth_);
  EXPECT_EQ(errors.poses, kRevolutions);
  EXPECT_EQ(errors.judged, kRevolutions);
  EXPECT_LT(errors.worst, 1e-6);
  EXPECT_LT(errors.nees, 1e-6);
}

TEST_F(PoseErrorsTest, AreSplitAcrossAndAlongTheVehicle) {
  const PoseErrors errors = errors_of(poses_with([] { return Eigen::Vector3d(-0.05, 0.03, 0.002); }), *truth_);
  EXPECT_NEAR(errors.lateral_rmse, 0.03, 1e-6);
  EXPECT_NEAR(errors.lateral_99, 0.03, 1e-6);
  EXPECT_NEAR(errors.longitudinal_rmse, 0.05, 1e-6);
  EXPECT_NEAR(errors.yaw_rmse, 0.002 * 180 / std::numbers::pi, 1e-6);
  EXPECT_NEAR(errors.worst, std::hypot(0.05, 0.03), 1e-6);
  EXPECT_NEAR(errors.nees, 25 + 9 + 4, 1e-3);
  EXPECT_EQ(errors.beyond_95, 1);
}

TEST_F(PoseErrorsTest, HaveANeesOfEachAxisOfTheVehicle) {
  auto poses = poses_with([] { return Eigen::Vector3d(-0.05, 0.03, 0.002); });
  for (map_pose_t& pose : poses) {  // wide along the vehicle, narrow across it
    const Eigen::Matrix2d R =
        pose_from_arrays(pose.map_base_position, pose.map_base_orientation).linear().topLeftCorner<2, 2>();
    const Eigen::Matrix2d covariance = R * Eigen::Vector2d(0.05 * 0.05, 0.01 * 0.01).asDiagonal() * R.transpose();
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 2; ++j) pose.covariance[i * 6 + j] = static_cast<float>(covariance(i, j));
    }
  }
  const PoseErrors errors = errors_of(poses, *truth_);
  EXPECT_NEAR(errors.nees_longitudinal, 1, 0.01);
  EXPECT_NEAR(errors.nees_lateral, 9, 0.2);  // the frame differs by the 0.002 rad of the error
  EXPECT_NEAR(errors.nees_yaw, 4, 1e-3);
}

TEST_F(PoseErrorsTest, HaveANeesOfThreeWhereTheCovarianceIsRight) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const auto drawn = [&] {
    return Eigen::Vector3d(0.01 * normal(random), 0.01 * normal(random), 0.001 * normal(random));
  };
  const PoseErrors errors = errors_of(poses_with(drawn), *truth_);
  EXPECT_NEAR(errors.nees, 3, 0.3);
  EXPECT_NEAR(errors.beyond_95, 0.05, 0.025);
}

TEST_F(PoseErrorsTest, OfLostPosesAreNotJudgedAndOfSureOnesAreCounted) {
  auto poses = poses_with([] { return Eigen::Vector3d(0, 0.6, 0); });
  for (std::size_t i = 0; i < 400; ++i) poses[i].flags = map_pose_t::LOST;
  const PoseErrors errors = errors_of(poses, *truth_);
  EXPECT_EQ(errors.lost, 400);
  EXPECT_EQ(errors.judged, kRevolutions - 400);
  EXPECT_EQ(errors.wrong_and_sure, kRevolutions - 400);
}

TEST_F(PoseErrorsTest, AlongAStreetThatDoesNotTellItAreLeftOut) {
  auto poses = poses_with([] { return Eigen::Vector3d(0.3, 0, 0); });
  for (map_pose_t& pose : poses) pose.degenerate = 1;
  const PoseErrors errors = errors_of(poses, *truth_);
  EXPECT_EQ(errors.degenerate, kRevolutions);
  EXPECT_EQ(errors.longitudinal_rmse, 0);
  EXPECT_NEAR(errors.longitudinal_all, 0.3, 1e-6);
}

TEST(TrueMapPose, OfAMapThatSlidSidewaysHasNotTurned) {
  evaluate::truth::Trajectory straight;
  std::vector<semantic_map::tile::TrajectoryPose> mapped;
  for (int i = 0; i < 400; ++i) {
    Pose pose = Pose::Identity();
    pose.translation().x() = 0.1 * i;
    straight.push_back({i * kRevolution, pose});
    pose.translation().y() += 0.01 * pose.translation().x();
    mapped.push_back({i * kRevolution, 0, pose});
  }
  const auto T_map_base = TrueMapPose(mapped, straight, straight).at(200 * kRevolution);
  ASSERT_TRUE(T_map_base);
  EXPECT_NEAR(T_map_base->translation().y(), 0.2, 0.005);
  EXPECT_NEAR(roll_pitch_yaw(T_map_base->linear()).z(), 0, 1e-9);
}

TEST(TrueMapPose, CountsAPlaceWhereTheMapperStoodOnce) {
  evaluate::truth::Trajectory driven;
  std::vector<semantic_map::tile::TrajectoryPose> mapped;
  for (int i = 0; i < 1000; ++i) {
    Pose pose = Pose::Identity();
    pose.translation().x() = i < 800 ? 0 : 0.1 * (i - 800);
    driven.push_back({i * kRevolution, pose});
    if (i >= 800) pose.translation().y() = 0.03;
    mapped.push_back({i * kRevolution, 0, pose});
  }
  const auto T_map_base = TrueMapPose(mapped, driven, driven).at(0);
  ASSERT_TRUE(T_map_base);
  EXPECT_GT(T_map_base->translation().y(), 0.027);
}

TEST_F(PoseErrorsTest, AwayFromTheMapThereIsNoTruth) {
  for (auto& pose : second_) pose.pose.translation().x() += 500;
  const TrueMapPose elsewhere({}, drive(0, 0), second_);
  EXPECT_FALSE(elsewhere.at(second_.front().utime));
}

}  // namespace
}  // namespace curbstone::localise
