#include "tools/localise/pose_errors.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "common/linear/decompositions.hpp"
#include "common/statistics/quantile.hpp"

namespace curbstone::localise {
namespace {

constexpr double kWrong = 0.5;  // m
constexpr int kFewPoses = 6;
constexpr double kChi95 = 7.815;  // for three degrees of freedom

double rms(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return values.empty() ? 0 : std::sqrt(sum / static_cast<double>(values.size()));
}

/// The covariance of x, y (map) and yaw.
Eigen::Matrix3d covariance_of(const map_pose_t& pose) {
  constexpr int kRows[3] = {0, 1, 5};
  Eigen::Matrix3d covariance;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) covariance(i, j) = static_cast<double>(pose.covariance[kRows[i] * 6 + kRows[j]]);
  }
  return covariance;
}

/// Squared errors along and across base_link and of yaw, each divided by its own variance.
Eigen::Vector3d nees_by_axis(const Eigen::Matrix3d& covariance, const Eigen::Vector3d& error, double heading) {
  Eigen::Matrix3d to_base = Eigen::Matrix3d::Identity();
  to_base.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(-heading).toRotationMatrix();
  const Eigen::Vector3d variances = (to_base * covariance * to_base.transpose()).diagonal();
  return (to_base * error).cwiseAbs2().cwiseQuotient(variances);
}

/// Collects the errors of the poses that have a truth.
class Judged {
 public:
  void add(const map_pose_t& pose, const Pose& T_map_base) {
    const Pose estimate = pose_from_arrays(pose.map_base_position, pose.map_base_orientation);
    const Pose error = T_map_base.inverse() * estimate;
    const Eigen::Vector3d off = estimate.translation() - T_map_base.translation();
    const double yaw = roll_pitch_yaw(error.linear()).z();
    across_.push_back(std::abs(error.translation().y()));
    along_.push_back(std::abs(error.translation().x()));
    yaws_.push_back(yaw * 180 / std::numbers::pi);
    if (pose.degenerate & 1)
      across_degenerate_.push_back(across_.back());
    else
      along_constrained_.push_back(along_.back());
    add_consistency(covariance_of(pose), {off.x(), off.y(), yaw}, roll_pitch_yaw(T_map_base.linear()).z());
    const double distance = off.head<2>().norm();
    worst_ = std::max(worst_, distance);
    wrong_ += distance >= kWrong ? 1 : 0;
  }

  void report(PoseErrors& errors) {
    errors.judged = static_cast<int>(across_.size());
    errors.degenerate = static_cast<int>(across_degenerate_.size());
    errors.lateral_rmse = rms(across_);
    errors.lateral_99 = quantile_or(across_, 0.99, 0);
    errors.lateral_degenerate_rmse = rms(across_degenerate_);
    errors.lateral_degenerate_99 = quantile_or(across_degenerate_, 0.99, 0);
    errors.longitudinal_rmse = rms(along_constrained_);
    errors.longitudinal_99 = quantile_or(along_constrained_, 0.99, 0);
    errors.longitudinal_all = rms(along_);
    errors.yaw_rmse = rms(yaws_);
    errors.worst = worst_;
    errors.wrong_and_sure = wrong_;
    if (errors.judged == 0) return;
    errors.nees = nees_ / errors.judged;
    errors.nees_longitudinal = nees_by_axis_.x() / errors.judged;
    errors.nees_lateral = nees_by_axis_.y() / errors.judged;
    errors.nees_yaw = nees_by_axis_.z() / errors.judged;
    errors.beyond_95 = static_cast<double>(beyond_) / errors.judged;
  }

 private:
  /// `error`: x, y (map) and yaw.
  void add_consistency(const Eigen::Matrix3d& covariance, const Eigen::Vector3d& error, double heading) {
    const double nees = error.dot(Ldlt<3>(covariance).solve(error));
    nees_ += nees;
    nees_by_axis_ += nees_by_axis(covariance, error, heading);
    beyond_ += nees <= kChi95 ? 0 : 1;
  }

  std::vector<double> across_, across_degenerate_;  // m
  std::vector<double> along_, along_constrained_;   // m
  std::vector<double> yaws_;                        // deg
  double nees_ = 0;                                 // sum
  Eigen::Vector3d nees_by_axis_ = Eigen::Vector3d::Zero();
  int beyond_ = 0;
  double worst_ = 0;  // m
  int wrong_ = 0;
};

}  // namespace

TrueMapPose::TrueMapPose(const std::vector<semantic_map::tile::TrajectoryPose>& map_drive,
                         evaluate::truth::Trajectory map_truth, evaluate::truth::Trajectory truth)
    : truth_(std::move(truth)) {
  for (const semantic_map::tile::TrajectoryPose& pose : map_drive) {
    const auto there = evaluate::truth::pose_at(map_truth, pose.utime);
    if (!there) continue;
    if (!drive_.truth.empty() && (drive_.truth.back().translation() - pose.T_map_base.translation()).norm() < kEvery)
      continue;
    drive_.truth.push_back(pose.T_map_base);
    drive_.estimate.push_back(*there);
  }
}

std::optional<Pose> TrueMapPose::at(std::int64_t utime) const {
  const auto T_world_base = evaluate::truth::pose_at(truth_, utime);
  if (!T_world_base) return std::nullopt;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector4d turn = Eigen::Vector4d::Zero();
  int count = 0;
  for (std::size_t i = 0; i < drive_.estimate.size(); ++i) {
    if ((drive_.estimate[i].translation() - T_world_base->translation()).norm() > kNear) continue;
    const Pose said = drive_.truth[i] * drive_.estimate[i].inverse() * *T_world_base;
    const Eigen::Vector4d q = Eigen::Quaterniond(said.linear()).coeffs();
    position += said.translation();
    turn += q.dot(turn) < 0 ? Eigen::Vector4d(-q) : q;
    ++count;
  }
  if (count < kFewPoses) return std::nullopt;
  Pose T_map_base = Pose::Identity();
  T_map_base.translation() = position / count;
  T_map_base.linear() = Eigen::Quaterniond(Eigen::Vector4d(turn.normalized())).toRotationMatrix();
  return T_map_base;
}

PoseErrors errors_of(const std::vector<map_pose_t>& poses, const TrueMapPose& truth) {
  PoseErrors errors;
  Judged judged;
  for (const map_pose_t& pose : poses) {
    ++errors.poses;
    if (pose.flags & map_pose_t::LOST) {
      ++errors.lost;
    } else if (const auto T_map_base = truth.at(pose.utime)) {
      judged.add(pose, *T_map_base);
    }
  }
  judged.report(errors);
  return errors;
}

}  // namespace curbstone::localise
