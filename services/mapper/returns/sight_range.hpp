#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "common/geometry/geometry.hpp"
#include "services/mapper/returns/verdict.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::returns {

/// Detects a LiDAR that sees nothing beyond some distance, in any direction: a dirty or wet window, fog, a wrong range
/// limit. A laser that looks down by kDown or more always meets something: the ground at the latest. If nothing at all
/// comes back from beyond a distance at which kMinLasers and a sixth of all would still be above the ground, and each
/// of these misses kMissing of the returns that the best laser has, then it is not the surroundings that end there. In
/// the open the lowest lasers reach farther; in a hall, or between houses, those lasers return from the walls.
///
/// Status only. A function of the calls. Pure; one thread. Counters: faults.lidar.short_sight (times that it began).
class SightRange {
 public:
  static constexpr double kDown = 0.03;    ///< rad below the horizon
  static constexpr double kMissing = 0.3;  ///< of the returns
  static constexpr int kMinLasers = 3;
  static constexpr int kLooks = 25;         ///< in a row
  static constexpr double kStray = 0.002;   ///< of the returns may be farther: mirror images
  static constexpr double kToGround = 0.9;  ///< of the distance to level ground: it may rise, but not on all sides

  explicit SightRange(const Pose& T_base_lidar) : T_base_lidar_(T_base_lidar.cast<float>()) {}

  /// To be called for each revolution, in lidar, once per 0.2 m or so of motion.
  void check(const scan::Scan& scan);
  /// m; nothing if it sees as far as there is something.
  [[nodiscard]] std::optional<double> range() const {
    return verdict_.holds() ? std::optional<double>(range_) : std::nullopt;
  }
  void add_faults(std::vector<std::string>& faults) const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  [[nodiscard]] bool is_short(const scan::Scan& scan);

  Eigen::Isometry3f T_base_lidar_;
  Verdict verdict_{kLooks, kLooks};
  double range_ = 0.0;  // m, of the last look that showed it
  Counters counters_;
};

}  // namespace curbstone::mapper::returns
