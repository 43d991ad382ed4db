#pragma once

#include <array>

#include "common/bus/counters.hpp"
#include "services/ekf/base/samples.hpp"
#include "services/ekf/detection/gyro_watch.hpp"
#include "services/ekf/model/estimate.hpp"

namespace curbstone::ekf::filter {

/// Replaces stuck gyro axes (GyroWatch) by an estimate.
///
/// The rate about such an axis is estimated instead of measured: the sample is set to 0 there, and the axis's bias
/// represents the rate, with the opposite sign, as a first-order Gauss-Markov process. All measurements that depend on
/// the rate then correct it by the usual equations: about the vertical the wheels' difference and the sideways force;
/// about the other axes the speeds of wheels and constraint against the accelerometer; at a standstill the rate is 0.
/// The covariance includes what they leave open, and the effect of a wrong track width or radius.
///
/// A stuck axis is detected some samples late. The rate that it has shown meanwhile, compared with the wheels, has
/// falsified attitude and position; both are corrected. When the axis works again its bias is restored, with the sigma
/// of a start.
///
/// While no axis is stuck nothing is changed. A value type; one thread.
class LostAxes {
 public:
  LostAxes(const base::EkfConfig& config, const model::Geometry& geometry) : config_(config), geometry_(geometry) {}

  /// Takes the IMU's next sample. `drives`: the wheels turn. Returns the sample to process: the same with 0 on stuck
  /// axes.
  base::ImuSample add(const base::ImuSample& sample, bool drives);
  /// Updates the belief, before it is predicted with that sample, for axes that get stuck, are stuck or work again.
  /// `wheel_yaw_rate`: rad/s, from the wheels. Counts faults.gyro_* and trusted.gyro_*. Returns whether an axis got
  /// stuck or works again.
  bool update(model::Belief& belief, double wheel_yaw_rate, bool standing, Counters& counters);

  [[nodiscard]] bool lost(int axis) const { return lost_[static_cast<std::size_t>(axis)]; }
  [[nodiscard]] bool any() const { return lost(0) || lost(1) || lost(2); }
  /// All are lost, and were right until they repeated their values: the tilt is as good as without an IMU.
  [[nodiscard]] bool all_got_stuck() const { return lost(0) && lost(1) && lost(2) && !declared_stuck(); }
  /// An axis is stuck by the sample's `stuck` flags, not because it repeats its value.
  [[nodiscard]] bool declared_stuck() const { return sample_.stuck[0] || sample_.stuck[1] || sample_.stuck[2]; }
  /// No working axis measures the turn about the vertical.
  [[nodiscard]] bool yaw_rate_unmeasured() const;
  /// rad/s, imu frame: the gyro's reading, stuck axes included.
  [[nodiscard]] const Eigen::Vector3d& measured_rate() const { return sample_.angular_rate; }
  /// The sample before the latest one, with 0 on axes that are lost now.
  [[nodiscard]] base::ImuSample previous_sample() const { return without_lost(before_); }

  /// The belief with the biases of lost axes restored, as for a gyro without lost axes.
  [[nodiscard]] model::Belief with_restored_biases(model::Belief belief) const;
  /// Sets the estimate's biases likewise.
  void restore_biases(model::Estimate& estimate) const;

 private:
  struct AccumulatedError {
    double angle = 0.0;                                  // rad, since the axis shows the same rate
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m, odom
  };
  [[nodiscard]] Eigen::Vector3d direction(int axis) const { return geometry_.R_base_imu.col(axis); }
  [[nodiscard]] base::ImuSample without_lost(base::ImuSample sample) const;
  void accumulate_error(int axis, const model::Belief& belief, double wheel_yaw_rate, double dt);
  void propagate_axis(int axis, model::Belief& belief, double driving, double dt) const;
  void mark_stuck(int axis, model::Belief& belief, double wheel_yaw_rate);
  void restore_bias(int axis, model::Belief& belief) const;

  base::EkfConfig config_;
  model::Geometry geometry_;
  detection::GyroWatch watch_;
  base::ImuSample sample_, before_;
  std::array<bool, 3> lost_{};
  std::array<double, 3> bias_{};  // rad/s, from when the axis last worked
  std::array<AccumulatedError, 3> error_{};
};

}  // namespace curbstone::ekf::filter
