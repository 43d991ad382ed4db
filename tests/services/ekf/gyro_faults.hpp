#pragma once

#include <algorithm>
#include <cmath>

#include "tests/services/ekf/simulated_drive.hpp"

namespace curbstone::ekf {

/// The drive with one axis of its gyro stuck at `rate` rad/s from `begin` to `end`, s after its first sample.
inline Drive with_stuck_axis(Drive drive, int axis, double rate, double begin, double end = 1e9) {
  for (base::ImuSample& sample : drive.imu) {
    const double t = base::seconds_between(drive.imu.front().utime, sample.utime);
    if (t >= begin && t < end) sample.angular_rate[axis] = rate;
  }
  return drive;
}

/// s after the first sample, from `earliest` to `latest`, when the vehicle turns fastest.
inline double middle_of_bend(const Drive& drive, double earliest, double latest) {
  double best = earliest;
  double fastest = 0.0;
  for (std::size_t i = 10; i < drive.truth.size(); ++i) {
    const double t = base::seconds_between(drive.truth.front().utime, drive.truth[i].utime);
    const Eigen::Matrix3d turned =
        drive.truth[i - 10].T_world_base.linear().transpose() * drive.truth[i].T_world_base.linear();
    const double turn = std::abs(roll_pitch_yaw(turned).z());
    if (t < earliest || t > latest || turn <= fastest) continue;
    fastest = turn;
    best = t;
  }
  return best;
}

}  // namespace curbstone::ekf
