#include "tests/services/ekf/simulated_drive.hpp"

#include <algorithm>
#include <cmath>

#include "tests/stamps.hpp"

namespace curbstone::ekf {

namespace {

using test::kStart;
constexpr double kStep = 2e-3;  // s, of the truth
constexpr int kSteps = 5;       // of the truth per sample
constexpr int kWheelPhase = 2;  // of the truth, wheels after IMU

double smooth_step(double t, double begin, double end) {
  const double x = std::clamp((t - begin) / (end - begin), 0.0, 1.0);
  return x * x * x * (10.0 + x * (-15.0 + 6.0 * x));
}

/// The plan of the drive: speed and yaw rate by time, the ground's slope by distance.
struct Plan {
  const DriveOptions& o;
  [[nodiscard]] double speed(double t) const {
    const double go = smooth_step(t, o.stand_first, o.stand_first + 3.0);
    const double end = o.stop_at + 4.0 + o.spin_seconds;
    const double stop = smooth_step(t, o.stop_at - 3.0, o.stop_at) - smooth_step(t, end, end + 3.0);
    return o.speed * (go - stop) * (1.0 + 0.2 * std::sin(0.7 * t));
  }
  [[nodiscard]] double yaw_rate(double t) const {
    const double begin = o.stop_at + 2.0;
    const double spin =
        smooth_step(t, begin, begin + 1.0) - smooth_step(t, begin + o.spin_seconds - 1.0, begin + o.spin_seconds);
    return (o.curves * std::sin(0.35 * t) + o.circle) * speed(t) / std::max(0.1, o.speed) + o.spin * spin * std::sin(t);
  }
  [[nodiscard]] Eigen::Matrix3d attitude(double yaw, double distance) const {
    return rotation_from_rpy(0.6 * o.hills * std::sin(distance / 7.0 + 1.0), o.hills * std::sin(distance / 9.0 + 0.5),
                             yaw);
  }
};

class Noise {
 public:
  explicit Noise(unsigned seed) : random_(seed) {}
  double operator()(double sigma) { return sigma * normal_(random_); }
  Eigen::Vector3d vector(double sigma) { return {(*this)(sigma), (*this)(sigma), (*this)(sigma)}; }

 private:
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

struct Track {
  std::vector<Pose> poses;  // every kStep
  std::vector<double> speed;
  std::vector<double> yaw_rate;  // about base_link's z
  double distance = 0.0;
};

Track follow(const Plan& plan, double seconds) {
  Track track;
  const auto n = static_cast<std::size_t>(seconds / kStep) + 3;
  double yaw = 0.0;
  Pose pose = Pose::Identity();
  pose.linear() = plan.attitude(0.0, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    const double t = kStep * static_cast<double>(i);
    track.poses.push_back(pose);
    track.speed.push_back(plan.speed(t));
    const double middle = plan.speed(t + 0.5 * kStep);
    const double half = track.distance + 0.25 * kStep * (plan.speed(t) + middle);
    const Eigen::Matrix3d R_middle = plan.attitude(yaw + 0.5 * kStep * plan.yaw_rate(t + 0.25 * kStep), half);
    pose.translation() += kStep * middle * R_middle.col(0);
    yaw += kStep * plan.yaw_rate(t + 0.5 * kStep);
    track.distance += kStep * middle;
    const Eigen::Matrix3d R_next = plan.attitude(yaw, track.distance);
    const Eigen::Quaterniond turn(pose.linear().transpose() * R_next);
    track.yaw_rate.push_back(so3_log(turn).z() / kStep);
    pose.linear() = R_next;
  }
  return track;
}

}  // namespace

Pose Drive::T_odom_base(std::size_t index, std::size_t start) const {
  const Pose& origin = truth[start].T_world_base;
  Pose T_world_odom = Pose::Identity();
  T_world_odom.translation() = origin.translation();
  T_world_odom.linear() = rotation_from_rpy(0, 0, roll_pitch_yaw(origin.linear()).z());
  return T_world_odom.inverse() * truth[index].T_world_base;
}

std::size_t Drive::index_of(std::int64_t utime) const {
  const auto it = std::lower_bound(truth.begin(), truth.end(), utime,
                                   [](const TruePose& pose, std::int64_t t) { return pose.utime < t; });
  return std::min(static_cast<std::size_t>(it - truth.begin()), truth.size() - 1);
}

Drive simulate_drive(const DriveOptions& o, const VehicleConfig& vehicle) {
  const Plan plan{o};
  const Track track = follow(plan, o.seconds);
  const Pose T_base_imu = vehicle.T_base_imu();
  const Eigen::Vector3d gravity(0, 0, -9.80665);
  Noise noise(o.seed);

  Drive drive;
  drive.distance = track.distance;
  Eigen::Vector3d gyro_bias = o.gyro_bias;
  Eigen::Vector3d accelerometer_bias = o.accelerometer_bias;
  std::array<double, 2> angle = {};
  std::array<double, 2> wheel_error = {};
  const double sample_dt = kStep * kSteps;
  const auto noise_steps = static_cast<std::size_t>(std::lround(o.wheel_noise_interval / kStep));
  for (std::size_t i = 1; i + 1 < track.poses.size(); ++i) {
    const double t = kStep * static_cast<double>(i);
    const std::int64_t utime = kStart + static_cast<std::int64_t>(std::llround(t * 1e6));
    if (i % noise_steps == 0)
      for (double& error : wheel_error) error = noise(o.wheel_speed_noise);
    const bool rolls = track.speed[i] > 1e-6;
    for (std::size_t wheel = 0; wheel < 2; ++wheel) {
      const double arm = (wheel == 0 ? -0.5 : 0.5) * vehicle.track_width * (1.0 + o.wheel_scale[2]);
      double speed = track.speed[i] + arm * track.yaw_rate[i] + (rolls ? wheel_error[wheel] : 0.0);
      if (t >= o.slip_begin && t < o.slip_end) speed *= 1.0 + (wheel == 0 ? o.slip_left : o.slip_right);
      angle[wheel] += kStep * speed / (vehicle.wheel_radius * (1.0 + o.wheel_scale[static_cast<int>(wheel)]));
    }
    if (i % kSteps == kWheelPhase) {
      const double count = 2.0 * M_PI / o.counts_per_turn;
      const auto jitter = static_cast<std::int64_t>(noise(o.stamp_jitter * 1e6));
      drive.wheels.push_back(
          {utime + jitter, {std::floor(angle[0] / count) * count, std::floor(angle[1] / count) * count}});
    }
    if (i % kSteps != 0) continue;
    const auto imu_at = [&](std::size_t k) -> Eigen::Vector3d { return (track.poses[k] * T_base_imu).translation(); };
    const Eigen::Matrix3d R_world_imu = (track.poses[i] * T_base_imu).linear();
    const Eigen::Quaterniond turn(track.poses[i - 1].linear().transpose() * track.poses[i + 1].linear());
    const Eigen::Vector3d rate_base = so3_log(turn) / (2.0 * kStep);
    const Eigen::Vector3d acceleration = (imu_at(i + 1) - 2.0 * imu_at(i) + imu_at(i - 1)) / (kStep * kStep);
    gyro_bias += noise.vector(o.gyro_bias_walk * std::sqrt(sample_dt));
    accelerometer_bias += noise.vector(o.accelerometer_bias_walk * std::sqrt(sample_dt));
    drive.imu.push_back(
        {utime,
         T_base_imu.linear().transpose() * rate_base + gyro_bias + noise.vector(o.gyro_noise / std::sqrt(sample_dt)),
         R_world_imu.transpose() * (acceleration - gravity) + accelerometer_bias +
             noise.vector(o.accelerometer_noise / std::sqrt(sample_dt))});
    drive.truth.push_back(
        {utime, track.poses[i], Eigen::Vector3d(track.speed[i], 0, 0), gyro_bias, accelerometer_bias});
  }
  return drive;
}

}  // namespace curbstone::ekf
