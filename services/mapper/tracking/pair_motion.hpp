#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "services/mapper/config/registration_config.hpp"
#include "services/mapper/registration/registration.hpp"
#include "services/mapper/scan/scan.hpp"
#include "services/mapper/tracking/way_check.hpp"

namespace curbstone::mapper::tracking {

/// How the vehicle moved from one scan to another a tenth of a second after it, by these two alone: neither the map nor
/// how far odometry went holds it. How far odometry turned does. Now and then, as it costs a registration. One thread.
class PairMotion {
 public:
  static constexpr std::int64_t kEach = 1'000'000;  ///< us, between pairs
  static constexpr std::int64_t kSoon = 200'000;    ///< us, where the last one left a doubt
  static constexpr std::int64_t kApart = 80'000;    ///< us, at least, from the first scan of a pair to the second
  static constexpr double kFar = 0.5;               ///< m that the way may be off odometry's

  /// `lidar`: where it is in base_link, m.
  PairMotion(const config::RegistrationConfig& config, const Eigen::Vector3d& lidar) : config_(config), lidar_(lidar) {}

  /// The next scan that ended at `utime`, us: de-skewed, in base_link. A pair if it is the second of one, and the
  /// surroundings tell how far it went. `soon`: the next is wanted after kSoon. `from_afar`: sought also as if the
  /// vehicle stood, or went the other way.
  [[nodiscard]] std::optional<WayCheck::Pair> take(std::int64_t utime, const std::vector<scan::LidarPoint>& points,
                                                   const Pose& T_odom_base, bool soon, bool from_afar);
  /// The next scan begins anew.
  void interrupt() { first_.reset(); }

 private:
  struct First {
    std::int64_t utime;
    Pose T_odom_base;
    std::unique_ptr<registration::Registration> map;  // of it alone
  };
  [[nodiscard]] std::optional<WayCheck::Pair> measure(const std::vector<scan::LidarPoint>& points,
                                                      const Pose& by_odometry, bool from_afar) const;

  config::RegistrationConfig config_;
  Eigen::Vector3d lidar_;
  std::optional<First> first_;
  std::int64_t measured_ = 0;  // us
};

}  // namespace curbstone::mapper::tracking
