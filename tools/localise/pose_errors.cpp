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
constexpr double kChi95 = 7.815;  // of three degrees of freedom

double rms(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return values.empty() ? 0 : std::sqrt(sum / static_cast<double>(values.size()));
}

/// Of x, y (map) and yaw.
Eigen::Matrix3d covariance_of(const map_pose_t& pose) {
  constexpr int kRows[3] = {0, 1, 5};
  Eigen::Matrix3d covariance;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) covariance(i, j) = static_cast<double>(pose.covariance[kRows[i] * 6 + kRows[j]]);
  }
  return covariance;
}

/// Squares of the errors along and across base_link and of yaw, each over its own variance.
Eigen::Vector3d nees_by_axis(const Eigen::Matrix3d& covariance, const Eigen::Vector3d& error, double heading) {
  Eigen::Matrix3d to_base = Eigen::Matrix3d::Identity();
  to_base.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(-heading).toRotationMatrix();
  const Eigen::Vector3d variances = (to_base * covariance * to_base.transpose()).diagonal();
  return (to_base * error).cwiseAbs2().cwiseQuotient(variances);
}

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
  std::vector<double> across, across_degenerate, along, along_all, yaws;
  double nees = 0;
  Eigen::Vector3d by_axis = Eigen::Vector3d::Zero();
  int beyond = 0;
  for (const map_pose_t& pose : poses) {
    ++errors.poses;
    if (pose.flags & map_pose_t::LOST) {
      ++errors.lost;
      continue;
    }
    const auto T_map_base = truth.at(pose.utime);
    if (!T_map_base) continue;
    ++errors.judged;
    const Pose estimate = pose_from_arrays(pose.map_base_position, pose.map_base_orientation);
    const Pose error = T_map_base->inverse() * estimate;
    const Eigen::Vector3d off = estimate.translation() - T_map_base->translation();
    const double yaw = roll_pitch_yaw(error.linear()).z();
    across.push_back(std::abs(error.translation().y()));
    yaws.push_back(yaw * 180 / std::numbers::pi);
    along_all.push_back(std::abs(error.translation().x()));
    if (pose.degenerate & 1) {
      ++errors.degenerate;
      across_degenerate.push_back(across.back());
    } else {
      along.push_back(along_all.back());
    }
    const Eigen::Vector3d planar(off.x(), off.y(), yaw);
    const Eigen::Matrix3d covariance = covariance_of(pose);
    const double one = planar.dot(Ldlt<3>(covariance).solve(planar));
    nees += one;
    by_axis += nees_by_axis(covariance, planar, roll_pitch_yaw(T_map_base->linear()).z());
    if (!(one <= kChi95)) ++beyond;
    errors.worst = std::max(errors.worst, off.head<2>().norm());
    if (off.head<2>().norm() >= kWrong) ++errors.wrong_and_sure;
  }
  errors.lateral_rmse = rms(across);
  errors.lateral_99 = quantile_or(across, 0.99, 0);
  errors.lateral_degenerate_rmse = rms(across_degenerate);
  errors.lateral_degenerate_99 = quantile_or(across_degenerate, 0.99, 0);
  errors.longitudinal_rmse = rms(along);
  errors.longitudinal_99 = quantile_or(along, 0.99, 0);
  errors.longitudinal_all = rms(along_all);
  errors.yaw_rmse = rms(yaws);
  if (errors.judged > 0) {
    errors.nees = nees / errors.judged;
    errors.nees_longitudinal = by_axis.x() / errors.judged;
    errors.nees_lateral = by_axis.y() / errors.judged;
    errors.nees_yaw = by_axis.z() / errors.judged;
    errors.beyond_95 = static_cast<double>(beyond) / errors.judged;
  }
  return errors;
}

}  // namespace curbstone::localise
