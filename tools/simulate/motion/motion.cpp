#include "tools/simulate/motion/motion.hpp"

namespace curbstone::simulate::motion {

Inertia inertia_at(const Motion& motion, const Pose& T_base_imu, double t) {
  constexpr double kStep = 2e-3;  // s: central differences
  const Pose before = motion.T_world_base(t - kStep) * T_base_imu;
  const Pose now = motion.T_world_base(t) * T_base_imu;
  const Pose after = motion.T_world_base(t + kStep) * T_base_imu;
  const Eigen::Vector3d acceleration =
      (after.translation() - 2.0 * now.translation() + before.translation()) / (kStep * kStep);
  const Eigen::Matrix3d turn = before.linear().transpose() * after.linear();
  return {now.linear().transpose() * (acceleration + Eigen::Vector3d(0, 0, kGravity)),
          so3_log(Eigen::Quaterniond(turn)) / (2.0 * kStep)};
}

double rolled_distance(const Motion& motion, const Eigen::Vector3d& point_base, double t0, double t1) {
  return rolled_distances(motion, {point_base, point_base}, t0, t1)[0];
}

std::array<double, 2> rolled_distances(const Motion& motion, const std::array<Eigen::Vector3d, 2>& points_base,
                                       double t0, double t1) {
  constexpr int kSteps = 4;
  std::array<double, 2> ways{};
  Pose last = motion.T_world_base(t0);
  for (int i = 1; i <= kSteps; ++i) {
    const Pose next = motion.T_world_base(t0 + (t1 - t0) * i / kSteps);
    const Eigen::Vector3d heading = (last.linear().col(0) + next.linear().col(0)).normalized();
    for (std::size_t k = 0; k < ways.size(); ++k) ways[k] += heading.dot(next * points_base[k] - last * points_base[k]);
    last = next;
  }
  return ways;
}

}  // namespace curbstone::simulate::motion
