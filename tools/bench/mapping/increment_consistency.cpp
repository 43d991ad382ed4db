#include "tools/bench/mapping/increment_consistency.hpp"

#include <algorithm>
#include <cstdlib>
#include <optional>

#include "common/geometry/pose_covariance.hpp"
#include "common/linear/decompositions.hpp"
#include "services/mapper/registration/normal_equations.hpp"

namespace curbstone::bench::mapping {
namespace {

/// Lagrange interpolation through two poses on either side, in the log of SE(3) about the pose before; empty outside.
std::optional<Pose> cubic_at(const evaluate::truth::Trajectory& truth, std::int64_t utime) {
  const auto after =
      std::lower_bound(truth.begin(), truth.end(), utime,
                       [](const evaluate::truth::StampedPose& p, std::int64_t t) { return p.utime < t; });
  if (after == truth.end()) return std::nullopt;
  if (after->utime == utime) return after->pose;
  if (after - truth.begin() < 2 || truth.end() - after < 2) return std::nullopt;
  const auto from = after - 2;
  const Pose& about = from[1].pose;
  mapper::registration::Vector6 change = mapper::registration::Vector6::Zero();
  for (int i = 0; i < 4; ++i) {
    double weight = 1;
    for (int k = 0; k < 4; ++k) {
      if (k == i) continue;
      weight *= static_cast<double>(utime - from[k].utime) / static_cast<double>(from[i].utime - from[k].utime);
    }
    change += weight * mapper::registration::log_of(about.inverse() * from[i].pose);
  }
  return about * mapper::registration::exp_of(change);
}

}  // namespace

void IncrementConsistency::add(const evaluate::truth::StampedPose& pose,
                               const mapper::registration::Matrix6& covariance) {
  const auto off = [&](const Claim& claim) { return std::abs(pose.utime - claim.stamped.utime - span_); };
  while (recent_.size() > 1 && off(recent_[1]) <= off(recent_[0])) recent_.pop_front();
  const Claim end{pose, covariance};
  if (!recent_.empty() && 4 * off(recent_.front()) <= span_) compare(recent_.front(), end);
  recent_.push_back(end);
}

void IncrementConsistency::compare(const Claim& begin, const Claim& end) {
  const auto true_begin = cubic_at(truth_, begin.stamped.utime), true_end = cubic_at(truth_, end.stamped.utime);
  if (!true_begin || !true_end) return;
  const Pose T_begin_end = begin.stamped.pose.inverse() * end.stamped.pose;
  const PoseCovariance P = covariance_of_increment(T_begin_end, begin.covariance, end.covariance);
  const mapper::registration::Vector6 error =
      mapper::registration::log_of((true_begin->inverse() * *true_end).inverse() * T_begin_end);
  const Eigen::Vector3d shift = error.head<3>(), turn = error.tail<3>();
  sum_.all += error.dot(Ldlt<6>(P).solve(error));
  sum_.translation += shift.dot(Ldlt<3>(P.topLeftCorner<3, 3>()).solve(shift));
  sum_.rotation += turn.dot(Ldlt<3>(P.bottomRightCorner<3, 3>()).solve(turn));
  ++sum_.increments;
}

Nees IncrementConsistency::mean() const {
  Nees mean = sum_;
  if (mean.increments == 0) return mean;
  for (double* sum : {&mean.all, &mean.translation, &mean.rotation}) *sum /= mean.increments;
  return mean;
}

}  // namespace curbstone::bench::mapping
