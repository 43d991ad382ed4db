#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <utility>
#include <vector>

#include "common/config/vehicle.hpp"
#include "common/geometry/geometry.hpp"
#include "services/mapper/config/registration_config.hpp"
#include "services/mapper/registration/registration.hpp"
#include "services/mapper/scan/deskew.hpp"
#include "services/mapper/scan/scan.hpp"
#include "services/mapper/tracking/motion_filter.hpp"
#include "services/mapper/tracking/motion_prediction.hpp"

namespace curbstone::mapper::tracking {

/// The vehicle's pose at the end of the last scan.
struct PreviousPose {
  std::int64_t end = 0;  ///< us
  Pose T_map_base = Pose::Identity();
  registration::Matrix6 drift =
      registration::Matrix6::Zero();  ///< its covariance in base_link axes if it was not registered; else zero
};

/// A registered scan.
struct Fit {
  MotionPrediction prediction;
  registration::PosePrior prior;            ///< the predicted pose
  registration::RegistrationResult result;  ///< the registered pose
  std::vector<scan::LidarPoint> points;     ///< de-skewed, in base_link
  MotionFilter motion;                      ///< without odometry: updated with this scan
  /// Points of the previous scan, de-skewed by what this scan shows of the motion: see ScanMatcher::fit_second().
  std::vector<scan::LidarPoint> first_points;
  /// 0..1: share of the scan's points that lie on a surface of the map.
  [[nodiscard]] double agreement() const { return result.overlap * result.inlier_ratio; }
};

/// De-skews a scan and registers it. With odometry these are two steps; without it, the motion within the scan is
/// estimated together with the pose. Owns the registration map. One thread.
class ScanMatcher {
 public:
  /// `max_speed`: m/s, highest speed at which a drive may begin.
  ScanMatcher(const config::RegistrationConfig& config, const VehicleConfig& vehicle, double max_speed);

  [[nodiscard]] registration::Registration& map() { return *registration_; }
  [[nodiscard]] const registration::Registration& map() const { return *registration_; }
  [[nodiscard]] std::unique_ptr<registration::Registration> empty_map() const;
  void replace_map(std::unique_ptr<registration::Registration> map) { registration_ = std::move(map); }
  void clear_map() { replace_map(empty_map()); }
  /// Sets how far the LiDAR has turned in its mount: `yaw`, rad, to the left of `vehicle.lidar`.
  void set_mount_yaw(double yaw);

  /// The scan at its predicted pose, not registered.
  [[nodiscard]] Fit predict(const PreviousPose& from, const scan::Scan& scan, MotionPrediction prediction) const;
  /// Registers the scan. `motion`: the vehicle's motion until now, from scans.
  [[nodiscard]] Fit fit(const PreviousPose& from, const scan::Scan& scan, MotionPrediction prediction,
                        const MotionFilter& motion);
  /// Registers the scan from other motions, after the predicted motion has failed and where there is no odometry.
  /// Returns the result that most points agree with.
  [[nodiscard]] Fit fit_multi_start(const PreviousPose& from, const scan::Scan& scan, const MotionFilter& motion);
  /// Registers the first two scans of a drive to each other when the speed is unknown: tries all speeds up to
  /// `max_speed`. The registration map becomes the first scan, de-skewed, which ended at `from`: Fit::first_points.
  [[nodiscard]] Fit fit_second(const PreviousPose& from, const scan::Scan& first, const scan::Scan& second);

  /// The points of the scan, de-skewed, in base_link, without those on the vehicle itself.
  [[nodiscard]] std::vector<scan::LidarPoint> in_base(const scan::Scan& scan, const scan::SweepMotion& sweep) const;

 private:
  [[nodiscard]] Fit refine_motion(const PreviousPose& from, const scan::Scan& scan, const MotionFilter& before,
                                  Fit fit);

  config::RegistrationConfig config_;
  double max_speed_;
  Pose T_base_lidar_;
  Eigen::Matrix3d R_base_lidar_;  ///< as in the vehicle's file
  Eigen::AlignedBox3f own_body_;  ///< in base_link, m
  std::unique_ptr<registration::Registration> registration_;
};

}  // namespace curbstone::mapper::tracking
