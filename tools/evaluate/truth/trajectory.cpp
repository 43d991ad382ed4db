#include "tools/evaluate/truth/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/linear/decompositions.hpp"

namespace curbstone::evaluate::truth {

std::optional<Pose> pose_at(const Trajectory& trajectory, std::int64_t utime, std::int64_t max_gap) {
  const auto after = std::lower_bound(trajectory.begin(), trajectory.end(), utime,
                                      [](const StampedPose& p, std::int64_t t) { return p.utime < t; });
  if (after == trajectory.end()) return std::nullopt;
  if (after->utime == utime) return after->pose;
  if (after == trajectory.begin()) return std::nullopt;
  const auto before = after - 1;
  const std::int64_t gap = after->utime - before->utime;
  if (gap > max_gap) return std::nullopt;
  return interpolate(before->pose, after->pose, static_cast<double>(utime - before->utime) / static_cast<double>(gap));
}

PosePairs pair_up(const Trajectory& truth, const Trajectory& estimate) {
  PosePairs pairs;
  for (const StampedPose& stamped : estimate) {
    if (const auto true_pose = pose_at(truth, stamped.utime)) {
      pairs.truth.push_back(*true_pose);
      pairs.estimate.push_back(stamped.pose);
    }
  }
  return pairs;
}

Pose align(const PosePairs& pairs) {
  if (pairs.truth.empty()) return Pose::Identity();
  Eigen::Vector3d mean_truth = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_estimate = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < pairs.truth.size(); ++i) {
    mean_truth += pairs.truth[i].translation();
    mean_estimate += pairs.estimate[i].translation();
  }
  const double n = static_cast<double>(pairs.truth.size());
  mean_truth /= n;
  mean_estimate /= n;

  Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < pairs.truth.size(); ++i) {
    correlation +=
        (pairs.truth[i].translation() - mean_truth) * (pairs.estimate[i].translation() - mean_estimate).transpose() / n;
    // A lever arm of half a metre along each body axis: it fixes what a straight or flat path leaves undetermined, and
    // has little weight otherwise.
    constexpr double kLever = 0.5;
    correlation += kLever * kLever * pairs.truth[i].linear() * pairs.estimate[i].linear().transpose() / n;
  }
  Pose T_truth_estimate = Pose::Identity();
  T_truth_estimate.linear() = nearest_rotation(correlation);
  T_truth_estimate.translation() = mean_truth - T_truth_estimate.linear() * mean_estimate;
  return T_truth_estimate;
}

namespace {

/// Distance driven up to each pose. Jitter of less than a millimetre is left out, so standing still adds nothing.
std::vector<double> distances(const std::vector<Pose>& path) {
  std::vector<double> driven(path.size(), 0.0);
  Eigen::Vector3d last = path.empty() ? Eigen::Vector3d::Zero() : Eigen::Vector3d(path.front().translation());
  for (std::size_t i = 1; i < path.size(); ++i) {
    const double step = (path[i].translation() - last).norm();
    driven[i] = driven[i - 1];
    if (step > 1e-3) {
      driven[i] += step;
      last = path[i].translation();
    }
  }
  return driven;
}

double absolute_error(const PosePairs& pairs) {
  const Pose T_truth_estimate = align(pairs);
  double squares = 0;
  for (std::size_t i = 0; i < pairs.truth.size(); ++i) {
    squares += (T_truth_estimate * pairs.estimate[i].translation() - pairs.truth[i].translation()).squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(pairs.truth.size()));
}

/// Sets the errors of the sub-paths, KITTI's metric. `driven`: m, up to each pose.
void set_relative_errors(const PosePairs& pairs, const std::vector<double>& driven, TrajectoryErrors& errors) {
  std::vector<double> lengths = {10, 20, 30, 40, 50, 60};
  std::erase_if(lengths, [&](double length) { return length > driven.back(); });
  if (lengths.empty()) lengths = {driven.back() / 2};
  double translation = 0;
  double rotation = 0;
  double next_start = 0;
  for (std::size_t first = 0; first < driven.size(); ++first) {
    if (driven[first] < next_start) continue;
    next_start = driven[first] + 1.0;
    for (const double length : lengths) {
      const auto end = std::lower_bound(driven.begin(), driven.end(), driven[first] + length);
      if (end == driven.end() || length <= 0) continue;
      const auto last = static_cast<std::size_t>(end - driven.begin());
      const Pose true_motion = pairs.truth[first].inverse() * pairs.truth[last];
      const Pose motion = pairs.estimate[first].inverse() * pairs.estimate[last];
      const Pose error = motion.inverse() * true_motion;
      translation += error.translation().norm() / length;
      rotation += angle_of(error) / length;
      ++errors.segments;
    }
  }
  if (errors.segments == 0) return;
  errors.rpe_percent = 100.0 * translation / errors.segments;
  errors.rpe_deg_per_m = rotation / errors.segments * 180.0 / std::numbers::pi;
}

}  // namespace

TrajectoryErrors trajectory_errors(const PosePairs& pairs) {
  TrajectoryErrors errors;
  if (pairs.truth.size() < 2) return errors;
  const std::vector<double> driven = distances(pairs.truth);
  errors.distance_m = driven.back();
  errors.ate_m = absolute_error(pairs);
  set_relative_errors(pairs, driven, errors);
  if (errors.distance_m > 0) {
    const Pose end = pairs.truth.front() * pairs.estimate.front().inverse() * pairs.estimate.back();
    errors.end_percent = 100.0 * (end.translation() - pairs.truth.back().translation()).norm() / errors.distance_m;
  }
  return errors;
}

}  // namespace curbstone::evaluate::truth
