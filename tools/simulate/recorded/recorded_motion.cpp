#include "tools/simulate/recorded/recorded_motion.hpp"

#include <algorithm>
#include <cmath>

#include "common/linear/decompositions.hpp"

namespace curbstone::simulate::recorded {

namespace {

/// Value at `at` of a parabola fitted to the samples around it, with higher weights for nearer ones.
Eigen::Matrix<double, 6, 1> smoothed(const std::vector<double>& times,
                                     const std::vector<Eigen::Matrix<double, 6, 1>>& states, double at) {
  constexpr double kReach = 0.55;  // s
  Eigen::Matrix3d A = 1e-9 * Eigen::Matrix3d::Identity();
  Eigen::Matrix<double, 3, 6> b = Eigen::Matrix<double, 3, 6>::Zero();
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double dt = times[i] - at;
    if (std::abs(dt) > kReach) continue;
    const double f = 1.0 - std::pow(std::abs(dt) / kReach, 3);
    const double weight = f * f * f;
    const Eigen::Vector3d row(1.0, dt, dt * dt);
    A += weight * row * row.transpose();
    b += weight * row * states[i].transpose();
  }
  const Ldlt<3> solver(A);
  Eigen::Matrix<double, 6, 1> value;
  for (int i = 0; i < 6; ++i) value[i] = solver.solve(b.col(i))[0];
  return value;
}

}  // namespace

double Playback::recording_time(double t) const {
  const double since = t - standstill_;
  if (since <= 0) return 0.0;
  const double f = std::min(1.0, since / ramp_);
  return ramp_ * f * f * f * (1.0 - 0.5 * f) + std::max(0.0, since - ramp_);  // integral of a smooth-step speed
}

double Playback::drive_time(double recorded) const {
  return recorded + standstill_ + 0.5 * ramp_;
}

RecordedMotion::RecordedMotion(const ScanSet& scans, const VehicleConfig& vehicle, const Eigen::Matrix3d& R_world_first,
                               const Playback& playback)
    : T_world_first_(Pose::Identity()), playback_(playback) {
  // Roll, pitch and an unwrapped yaw.
  std::vector<State> states;
  const Pose T_base_lidar = vehicle.T_base_lidar();
  double last_yaw = 0;
  for (const Pose& T_first_scan : scans.T_first_scan) {
    Pose T_world_base = Pose::Identity();
    T_world_base.linear() = R_world_first;
    T_world_base = T_world_base * T_first_scan * T_base_lidar.inverse();
    Eigen::Vector3d rpy = roll_pitch_yaw(T_world_base.linear());
    rpy.z() += 2.0 * M_PI * std::round((last_yaw - rpy.z()) / (2.0 * M_PI));
    last_yaw = rpy.z();
    State state;
    state << T_world_base.translation(), rpy;
    states.push_back(state);
  }
  std::vector<State> knots;
  for (double t = 0; t <= scans.times.back(); t += kKnot) knots.push_back(smoothed(scans.times, states, t));
  spline_ = numerics::Spline<State>(knots, false);
  const Eigen::Vector3d origin = spline_.at(0).head<3>();
  T_world_first_.linear() = R_world_first;
  T_world_first_.translation() = -origin;
}

Pose RecordedMotion::T_world_base(double t) const {
  const State state = spline_.at(playback_.recording_time(t) / kKnot);
  Pose T = Pose::Identity();
  T.translation() = state.head<3>() + T_world_first_.translation();
  T.linear() = rotation_from_rpy(state[3], state[4], state[5]);
  return T;
}

Pose recorded_pose(const ScanSet& scans, double recorded) {
  const auto after = std::upper_bound(scans.times.begin(), scans.times.end(), recorded) - scans.times.begin();
  const auto high = static_cast<std::size_t>(
      std::clamp<std::ptrdiff_t>(after, 1, static_cast<std::ptrdiff_t>(scans.times.size()) - 1));
  const double f = (recorded - scans.times[high - 1]) / (scans.times[high] - scans.times[high - 1]);
  return interpolate(scans.T_first_scan[high - 1], scans.T_first_scan[high], std::clamp(f, -1.0, 2.0));
}

}  // namespace curbstone::simulate::recorded
