#pragma once

#include "services/ekf/base/ekf_config.hpp"
#include "services/ekf/model/estimate.hpp"

namespace curbstone::ekf::filter {

/// Keeps odom continuous (REP-105) while the filter corrects position and heading.
///
/// A filter that was started on the move learns its gyro bias at the first stop and with it, by their covariance, the
/// error of heading and position: ten degrees and metres within a second. A mapper needs undisturbed increments of
/// odometry; a user of the position needs it to be right in the end. So the published pose continues from where it was
/// and approaches the belief as the vehicle drives: by a small share of the distance, and no faster than an unknown
/// gyro bias would turn it anyway.
///
/// Poses are T_odom_base. Only position and heading are held back; tilt is not. A value type; one thread.
class OdomSmoother {
 public:
  explicit OdomSmoother(const base::SpreadConfig& config) : config_(config) {}

  /// A correction has moved the belief from `before` to `after`.
  void corrected(const Pose& before, const Pose& after);
  /// The vehicle, believed to be at `now`, has moved by `metres` within `seconds`.
  void moved(const Pose& now, double metres, double seconds);

  /// Converts an estimate of the belief to the published one. Its covariance grows by the square of what is held back,
  /// which is a known error.
  void apply(model::Estimate& estimate) const;
  /// Pose without any correction by the filter and without smoothing: its increments are those that were measured.
  [[nodiscard]] Pose uncorrected(const Pose& believed) const { return T_uncorrected_belief_ * believed; }

 private:
  base::SpreadConfig config_;
  Pose T_odom_belief_ = Pose::Identity();  // 4 degrees of freedom, like the next one
  Pose T_uncorrected_belief_ = Pose::Identity();
};

}  // namespace curbstone::ekf::filter
