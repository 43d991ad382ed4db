#pragma once

#include "services/ekf/base/ekf_config.hpp"
#include "services/ekf/model/estimate.hpp"

namespace curbstone::ekf::filter {

/// Keeps odom continuous (REP-105) while the filter corrects position and heading.
///
/// A filter that was started on the move learns its gyro bias at the first stop, and with it, by the covariance of the
/// two, how far heading and place have gone astray: ten degrees and metres within a second. Who maps with odometry
/// wants its increments undisturbed; who looks at the place wants it right in the end. So what is published goes on
/// from where it was, and comes nearer to the belief as the vehicle drives: by a small share of its way, and no faster
/// than a gyro's bias turns it anyway.
///
/// Poses are T_odom_base. Only position and the turn about the vertical are held back, tilt is not. A value type; one
/// thread.
class OdomSmoother {
 public:
  explicit OdomSmoother(const base::SpreadConfig& config) : config_(config) {}

  /// The belief was at `before`, and a correction has put it to `after`.
  void corrected(const Pose& before, const Pose& after);
  /// The vehicle, believed to be at `now`, has moved by so many metres within so many seconds.
  void moved(const Pose& now, double metres, double seconds);

  /// Turns an estimate of the belief into what is published: its covariance grows by the square of what is held back, a
  /// known error that was chosen to be kept.
  void apply(model::Estimate& estimate) const;
  /// Where the vehicle would be believed to be had nothing been corrected, nor made up for: its increments are what was
  /// measured.
  [[nodiscard]] Pose uncorrected(const Pose& believed) const { return T_uncorrected_belief_ * believed; }

 private:
  base::SpreadConfig config_;
  Pose T_odom_belief_ = Pose::Identity();  // 4 degrees of freedom, like the next
  Pose T_uncorrected_belief_ = Pose::Identity();
};

}  // namespace curbstone::ekf::filter
