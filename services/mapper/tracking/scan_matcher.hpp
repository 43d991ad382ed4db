#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <vector>

#include "common/config/vehicle.hpp"
#include "common/geometry/geometry.hpp"
#include "services/mapper/config/registration_config.hpp"
#include "services/mapper/registration/registration.hpp"
#include "services/mapper/scan/deskew.hpp"
#include "services/mapper/scan/scan.hpp"
#include "services/mapper/tracking/motion_expectation.hpp"
#include "services/mapper/tracking/motion_filter.hpp"

namespace curbstone::mapper::tracking {

/// Where the vehicle was at the end of the last scan.
struct Departure {
  std::int64_t end = 0;  ///< us
  Pose T_map_base = Pose::Identity();
  registration::Matrix6 drift =
      registration::Matrix6::Zero();  ///< covariance of it, in base_link axes, if it is only a guess
};

/// A scan in the map.
struct Fit {
  MotionExpectation expected;
  registration::PosePrior prior;            ///< where it was sought
  registration::RegistrationResult result;  ///< where it is
  std::vector<scan::LidarPoint> points;     ///< de-skewed, in base_link
  MotionFilter motion;                      ///< without odometry: what it has learnt of the motion
  /// Of the scan before, where this one shows how that was distorted: see ScanMatcher::fit_second().
  std::vector<scan::LidarPoint> first_points;
  /// 0..1: share of the scan's points that lie on a surface of the map.
  [[nodiscard]] double agreement() const { return result.overlap * result.inlier_ratio; }
};

/// De-skews a scan and registers it: with odometry one after the other; without, the motion within the scan
/// is sought along with the pose. Keeps the map for registration. One thread.
class ScanMatcher {
 public:
  /// `max_speed`: m/s, at which a drive may begin.
  ScanMatcher(const config::RegistrationConfig& config, const VehicleConfig& vehicle, double max_speed);

  [[nodiscard]] registration::Registration& map() { return *registration_; }
  [[nodiscard]] const registration::Registration& map() const { return *registration_; }
  void clear_map();

  /// The scan as it is expected to lie, not registered.
  [[nodiscard]] Fit expect(const Departure& from, const scan::Scan& scan, MotionExpectation expected) const;
  /// Registers it. `motion`: how the vehicle moved until now, as far as scans show.
  [[nodiscard]] Fit fit(const Departure& from, const scan::Scan& scan, MotionExpectation expected,
                        const MotionFilter& motion);
  /// Where the expectation has failed and there is no odometry: begins from other motions too, and gives the answer
  /// that most points agree with.
  [[nodiscard]] Fit fit_from_afar(const Departure& from, const scan::Scan& scan, const MotionFilter& motion);
  /// The first two scans of a drive, where nothing tells how fast it is: seeks at all speeds up to `max_speed`.
  /// The map for registration becomes the first, de-skewed, which ended at `from`: Fit::first_points.
  [[nodiscard]] Fit fit_second(const Departure& from, const scan::Scan& first, const scan::Scan& second);

  /// De-skewed, in base_link, without what the vehicle sees of itself.
  [[nodiscard]] std::vector<scan::LidarPoint> in_base(const scan::Scan& scan, const scan::SweepMotion& sweep) const;

 private:
  [[nodiscard]] Fit refine_motion(const Departure& from, const scan::Scan& scan, const MotionFilter& before, Fit fit);

  config::RegistrationConfig config_;
  double max_speed_;
  Pose T_base_lidar_;
  Eigen::AlignedBox3f own_body_;  ///< base_link
  std::unique_ptr<registration::Registration> registration_;
};

}  // namespace curbstone::mapper::tracking
