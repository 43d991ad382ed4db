#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "services/mapper/config/registration_config.hpp"
#include "services/mapper/registration/registration.hpp"
#include "services/mapper/scan/scan.hpp"
#include "services/mapper/tracking/odometry_check.hpp"

namespace curbstone::mapper::tracking {

/// Measures the motion between two scans a tenth of a second apart from these scans alone. Neither the map nor
/// odometry's translation constrains it, only odometry's rotation. Each pair costs a registration, so one is measured
/// each kPeriod. One thread.
class ScanToScanMotion {
 public:
  static constexpr std::int64_t kPeriod = 1'000'000;     ///< us, between pairs
  static constexpr std::int64_t kShortPeriod = 200'000;  ///< us, after a pair that differed from odometry
  static constexpr std::int64_t kMinInterval = 80'000;   ///< us, minimum between the two scans of a pair
  static constexpr double kMaxDeviation = 0.5;           ///< m, largest distance from odometry's

  /// `lidar`: where it is in base_link, m.
  ScanToScanMotion(const config::RegistrationConfig& config, const Eigen::Vector3d& lidar)
      : config_(config), lidar_(lidar) {}

  /// Takes the next scan, which ended at `utime`, us; points de-skewed, in base_link. Returns a pair if this scan is
  /// the second of one and the surroundings constrain both directions in the plane. `is_suspect`: begin the next pair
  /// after kShortPeriod instead of kPeriod. `multi_start`: registration also begins from a standing vehicle, and from
  /// the opposite way.
  [[nodiscard]] std::optional<OdometryCheck::Pair> take(std::int64_t utime, const std::vector<scan::LidarPoint>& points,
                                                        const Pose& T_odom_base, bool is_suspect, bool multi_start);
  /// Drops the first scan of a pair: the next scan begins a new pair.
  void interrupt() { first_.reset(); }

 private:
  struct First {
    std::int64_t utime;
    Pose T_odom_base;
    std::unique_ptr<registration::Registration> map;  // of this scan alone
  };
  [[nodiscard]] std::optional<OdometryCheck::Pair> measure(const std::vector<scan::LidarPoint>& points,
                                                           const Pose& by_odometry, bool multi_start) const;

  config::RegistrationConfig config_;
  Eigen::Vector3d lidar_;
  std::optional<First> first_;
  std::int64_t measured_ = 0;  // us, end of the last pair
};

}  // namespace curbstone::mapper::tracking
