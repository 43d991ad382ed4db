#include "services/ekf/filter/odom_smoother.hpp"

#include <algorithm>

namespace curbstone::ekf::filter {

namespace {

double turn_of(const Pose& T) {
  return roll_pitch_yaw(T.linear()).z();
}

/// Translation and turn about the vertical that take `from` to `to`, as a change of their reference frame.
Pose upright_change(const Pose& from, const Pose& to) {
  Pose change = Pose::Identity();
  change.linear() = rotation_from_rpy(0, 0, roll_pitch_yaw(to.linear() * from.linear().transpose()).z());
  change.translation() = to.translation() - change.linear() * from.translation();
  return change;
}

}  // namespace

void OdomSmoother::corrected(const Pose& before, const Pose& after) {
  const Pose back = upright_change(after, before);
  T_odom_belief_ = T_odom_belief_ * back;
  T_uncorrected_belief_ = T_uncorrected_belief_ * back;
}

void OdomSmoother::moved(const Pose& now, double metres, double seconds) {
  if (!(metres > 0.0)) return;
  const Eigen::Vector3d held_back = T_odom_belief_ * now.translation() - now.translation();
  const double turned = turn_of(T_odom_belief_);
  const double far = held_back.norm();
  const double turn = std::min(std::abs(turned), config_.turning * seconds);
  const double step = std::min(far, config_.share * metres);
  T_odom_belief_.linear() = rotation_from_rpy(0, 0, turned - std::copysign(turn, turned));
  const Eigen::Vector3d left = far > 0.0 ? Eigen::Vector3d((1.0 - step / far) * held_back) : held_back;
  T_odom_belief_.translation() = now.translation() + left - T_odom_belief_.linear() * now.translation();
}

void OdomSmoother::apply(model::Estimate& e) const {
  const Eigen::Vector3d believed = e.T_odom_base.translation();
  e.T_odom_base = T_odom_belief_ * e.T_odom_base;
  e.acceleration = T_odom_belief_.linear() * e.acceleration;
  const Eigen::Vector3d up = e.T_odom_base.linear().row(2);  // odom's z in base_link
  Eigen::Matrix<double, 6, 1> held_back;
  held_back << e.T_odom_base.translation() - believed, turn_of(T_odom_belief_) * up;
  e.pose_covariance += held_back * held_back.transpose();
}

}  // namespace curbstone::ekf::filter
