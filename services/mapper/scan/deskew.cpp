#include "services/mapper/scan/deskew.hpp"

#include <algorithm>
#include <cmath>

namespace curbstone::mapper::scan {
namespace {

/// The left Jacobian of SO(3): maps the linear part of a twist to the translation (Sola et al. 2018, eq. 145).
Eigen::Matrix3d left_jacobian(const Eigen::Vector3d& w) {
  const double angle2 = w.squaredNorm();
  const Eigen::Matrix3d W = skew(w);
  if (angle2 < 1e-10) return Eigen::Matrix3d::Identity() + 0.5 * W + W * W / 6.0;
  const double angle = std::sqrt(angle2);
  return Eigen::Matrix3d::Identity() + (1 - std::cos(angle)) / angle2 * W +
         (angle - std::sin(angle)) / (angle2 * angle) * W * W;
}

}  // namespace

Pose move(const Twist& twist, double seconds) {
  const Eigen::Vector3d w = seconds * twist.angular;
  Pose motion = Pose::Identity();
  motion.linear() = so3_exp(w).toRotationMatrix();
  motion.translation() = left_jacobian(w) * (seconds * twist.linear);
  return motion;
}

Twist twist_of(const Pose& motion, double seconds) {
  if (!(seconds > 0)) return {};
  const Eigen::Vector3d w = so3_log(Eigen::Quaterniond(motion.linear()));
  return {left_jacobian(w).inverse() * motion.translation() / seconds, w / seconds};
}

SweepMotion steady_sweep(const Twist& twist, double seconds, double step) {
  SweepMotion sweep;
  sweep.step = step;
  const int steps = std::max(1, static_cast<int>(std::ceil(seconds / step)));
  for (int i = 0; i <= steps; ++i) sweep.T_end_at.push_back(move(twist, i * step - seconds));
  return sweep;
}

bool measured(const LidarPoint& point) {
  constexpr float kMinRange = 0.1F, kMaxRange = 1000.0F;  // m
  const float range2 = point.position.squaredNorm();
  return range2 > kMinRange * kMinRange && range2 < kMaxRange * kMaxRange && std::isfinite(point.time);
}

std::vector<LidarPoint> deskew(const std::vector<LidarPoint>& points, const Pose& T_base_lidar,
                               const SweepMotion& sweep) {
  std::vector<Eigen::Isometry3f> T_end_lidar;
  T_end_lidar.reserve(sweep.T_end_at.size());
  for (const Pose& T_end_base : sweep.T_end_at) T_end_lidar.push_back((T_end_base * T_base_lidar).cast<float>());

  const auto inverse_step = static_cast<float>(1.0 / sweep.step);
  const auto last = static_cast<float>(T_end_lidar.size() - 1);
  std::vector<LidarPoint> out;
  out.reserve(points.size());
  for (const LidarPoint& point : points) {
    if (!measured(point)) continue;
    const float place = std::clamp(point.time * inverse_step, 0.0F, last);
    const std::size_t before = std::min(static_cast<std::size_t>(place), T_end_lidar.size() - 2);
    const float fraction = place - static_cast<float>(before);
    const Eigen::Vector3f a = T_end_lidar[before] * point.position;
    const Eigen::Vector3f b = T_end_lidar[before + 1] * point.position;
    out.push_back(point);
    out.back().position = a + fraction * (b - a);
  }
  return out;
}

}  // namespace curbstone::mapper::scan
