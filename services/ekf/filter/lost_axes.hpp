#pragma once

#include <array>

#include "common/bus/counters.hpp"
#include "services/ekf/base/samples.hpp"
#include "services/ekf/detection/gyro_watch.hpp"
#include "services/ekf/model/estimate.hpp"

namespace curbstone::ekf::filter {

/// Does without axes of the gyro that are stuck (GyroWatch).
///
/// How the vehicle turns about such an axis is estimated instead of measured: the sample shows 0 there, and the bias
/// stands for the rate, with the opposite sign, as a first-order Gauss-Markov process. Then all that depends on the
/// rate tells of it by the equations that there are: about the vertical the wheels' difference and the force sideways,
/// about the others the wheels' and the constraint's speeds against the accelerometer's; at a standstill it is 0. What
/// they leave open is in the covariance, and so is what a wrong track or radius makes of it.
///
/// An axis is found some samples late. By what it has shown meanwhile, against the wheels, the attitude has gone wrong
/// and the place with it; both are put back. When it lives again its bias is what it was, as well as a bias is known
/// at a start.
///
/// As long as no axis is stuck nothing is changed. A value type; one thread.
class LostAxes {
 public:
  LostAxes(const base::EkfConfig& config, const model::Geometry& geometry) : config_(config), geometry_(geometry) {}

  /// The IMU's next sample. Returns the one to go on with: the same, but 0 on axes that are stuck.
  base::ImuSample add(const base::ImuSample& sample);
  /// Has the belief, not yet predicted with that sample, follow what is lost. `wheel_yaw_rate`: rad/s, as the wheels
  /// turn it. Counts faults.gyro_* and trusted.gyro_*; says whether there was one.
  bool follow(model::Belief& belief, double wheel_yaw_rate, bool standing, Counters& counters);

  [[nodiscard]] bool lost(int axis) const { return lost_[static_cast<std::size_t>(axis)]; }
  [[nodiscard]] bool any() const { return lost(0) || lost(1) || lost(2); }
  /// An axis is lost by another's word, not because it repeats itself.
  [[nodiscard]] bool declared_stuck() const { return sample_.stuck[0] || sample_.stuck[1] || sample_.stuck[2]; }
  /// No axis tells how it turns about the vertical.
  [[nodiscard]] bool turn_is_lost() const;
  /// rad/s, imu frame: what the gyro shows.
  [[nodiscard]] const Eigen::Vector3d& shown() const { return sample_.angular_rate; }
  /// The sample before the last one, with 0 on axes that are lost now.
  [[nodiscard]] base::ImuSample before() const { return without_lost(before_); }

  /// The belief of a gyro of which no axis is lost.
  [[nodiscard]] model::Belief with_biases(model::Belief belief) const;
  /// Likewise what is said of the biases.
  void tell_biases(model::Estimate& estimate) const;

 private:
  struct Astray {
    double turn = 0.0;                                // rad, since the axis shows the same rate
    Eigen::Vector3d place = Eigen::Vector3d::Zero();  // m, odom
  };
  [[nodiscard]] Eigen::Vector3d direction(int axis) const { return geometry_.R_base_imu.col(axis); }
  [[nodiscard]] base::ImuSample without_lost(base::ImuSample sample) const;
  void go_astray(int axis, const model::Belief& belief, double wheel_yaw_rate, double dt);
  void age(int axis, model::Belief& belief, double driving, double dt) const;
  void lose(int axis, model::Belief& belief, double wheel_yaw_rate);
  void regain(int axis, model::Belief& belief) const;

  base::EkfConfig config_;
  model::Geometry geometry_;
  detection::GyroWatch watch_;
  base::ImuSample sample_, before_;
  std::array<bool, 3> lost_{};
  std::array<double, 3> bias_{};  // rad/s, by when it lived last
  std::array<Astray, 3> astray_{};
};

}  // namespace curbstone::ekf::filter
