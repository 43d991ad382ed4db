#pragma once

#include <vector>

#include "common/config/vehicle.hpp"
#include "tools/simulate/motion/motion.hpp"
#include "tools/simulate/numerics/spline.hpp"
#include "tools/simulate/recorded/scan_set.hpp"

namespace curbstone::simulate::recorded {

/// The time in the recording for a time of the emulated drive. The drive holds the first pose for a while, so that the
/// IMU can be levelled, accelerates, and then runs at the recorded speed.
class Playback {
 public:
  Playback(double standstill, double ramp) : standstill_(standstill), ramp_(ramp) {}
  [[nodiscard]] double recording_time(double t) const;     ///< s from the first scan
  [[nodiscard]] double drive_time(double recorded) const;  ///< the inverse, for times after the ramp

 private:
  double standstill_, ramp_;
};

/// The recorded poses as a smooth motion of the vehicle: a centimetre of noise between poses would be metres per second
/// squared to an IMU. The world is levelled by `R_world_first`; its origin is base_link at the start.
class RecordedMotion final : public motion::Motion {
 public:
  RecordedMotion(const ScanSet& scans, const VehicleConfig& vehicle, const Eigen::Matrix3d& R_world_first,
                 const Playback& playback);
  [[nodiscard]] Pose T_world_base(double t) const override;

  /// The lidar frame of the first scan, in which the recorded poses are given.
  [[nodiscard]] const Pose& T_world_first() const { return T_world_first_; }

 private:
  using State = Eigen::Matrix<double, 6, 1>;  // x y z, roll pitch yaw, of base_link
  static constexpr double kKnot = 0.1;        // s

  Pose T_world_first_;
  numerics::Spline<State> spline_;
  Playback playback_;
};

/// The recorded poses, interpolated: lidar in the lidar frame of the first scan, at seconds from the first scan.
[[nodiscard]] Pose recorded_pose(const ScanSet& scans, double recorded);

}  // namespace curbstone::simulate::recorded
