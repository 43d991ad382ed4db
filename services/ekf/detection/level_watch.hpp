#pragma once

#include <cstdint>
#include <optional>

#include "services/ekf/base/ekf_config.hpp"
#include "services/ekf/base/samples.hpp"

namespace curbstone::ekf::detection {

/// Decides whether roll and pitch are known well enough for the odometry to be used. A start on the move, or a reset by
/// doubt, leaves them uncertain by degrees, and the first corrections swing them into place at once. A mapper that took
/// this swing for motion would tilt its map.
class LevelWatch {
 public:
  void begin(bool level, std::int64_t utime) {
    level_ = level;
    levelled_.reset();
    since_ = utime;
  }
  /// `sigma`: the larger one of roll and pitch, rad. Returns whether the level was lost with this call.
  bool update(double sigma, bool standing, std::int64_t utime, const base::StartConfig& config) {
    if (utime < since_) begin(level_, utime);  // the clock was set back
    const bool lost = level_ && !standing && sigma > kLost * config.level_sigma;
    if (lost) begin(false, utime);
    if (sigma <= config.level_sigma || base::seconds_between(since_, utime) > config.level_patience) {
      if (!level_) levelled_ = utime;
      level_ = true;
    }
    return lost;
  }
  [[nodiscard]] bool level() const { return level_; }
  /// It has been level for less than kFresh: roll and pitch rest on few measurements.
  [[nodiscard]] bool is_fresh(std::int64_t utime) const {
    return levelled_ && base::seconds_between(*levelled_, utime) < kFresh;
  }

 private:
  static constexpr double kFresh = 2.0;  // s
  static constexpr double kLost = 4.0;   // times level_sigma, beyond which the level is lost
  bool level_ = false;
  std::optional<std::int64_t> levelled_;  // us, since when it is level, if it was not level before
  std::int64_t since_ = 0;                // us, of the last change for the worse
};

}  // namespace curbstone::ekf::detection
