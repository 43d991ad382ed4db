#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

namespace curbstone::mapper::journal {

/// Selects the poses of a drive to keep: all of them, but only one a second once the vehicle has stood for a minute. So
/// a day at a loading ramp needs hardly any memory. Pure.
class PoseThinning {
 public:
  static constexpr std::int64_t kStood = 60'000'000;   ///< us
  static constexpr std::int64_t kSpacing = 1'000'000;  ///< us
  static constexpr double kPlace = 0.03;               ///< m

  /// Whether the next pose, at `position` (m in map), is kept.
  [[nodiscard]] bool keeps(std::int64_t utime, const Eigen::Vector3d& position) {
    const bool stands = place_ && utime >= place_->kept && (position - place_->position).norm() < kPlace;
    if (!stands) {
      place_ = Place{position, utime, utime};
      return true;
    }
    if (utime - place_->since > kStood && utime - place_->kept < kSpacing) return false;
    place_->kept = utime;
    return true;
  }

 private:
  struct Place {
    Eigen::Vector3d position;
    std::int64_t since, kept;  // us: start of the standstill, and the last pose kept
  };
  std::optional<Place> place_;
};

}  // namespace curbstone::mapper::journal
