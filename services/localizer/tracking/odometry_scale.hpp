#pragma once

#include "services/localizer/tracking/pose_fit.hpp"
#include "services/localizer/tracking/pose_tracker.hpp"

namespace curbstone::localizer::tracking {

/// The factor by which odometry measures the way too long or too short, relative to the map: worn tyres, or a map that
/// was stretched where nothing showed the mapper how far it drove. It is estimated with the pose, as a seventh state of
/// the filter: a street without walls then costs little of the pose, and its covariance grows there as the error does.
/// Pure.
class OdometryScale {
 public:
  /// The motion by the scale known so far.
  [[nodiscard]] Motion corrected(const Motion& motion) const;
  /// Returns `predicted`, the belief `before` moved by `motion` (as corrected), with the error of the scale added.
  [[nodiscard]] PoseBelief predict(const PoseBelief& before, const Motion& motion, PoseBelief predicted);
  /// Learns from the correction of a predicted pose.
  void update(const PoseBelief& predicted, const PoseBelief& corrected);
  /// The pose is another one, by no motion.
  void forget_pose() { with_pose_.setZero(); }

  [[nodiscard]] double value() const { return value_; }  ///< relative; 0.01: odometry measures 1 % too little
  [[nodiscard]] double sigma() const;

 private:
  static constexpr double kSigma = 0.01;  ///< before anything is known

  double value_ = 0;
  double variance_ = kSigma * kSigma;
  Vector6 with_pose_ = Vector6::Zero();  // covariance with the pose
};

}  // namespace curbstone::localizer::tracking
