#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

namespace curbstone::mapper::journal {

/// Which poses of a drive are kept: all of them, but only one a second of a vehicle that has stood for a minute. A day
/// at a loading ramp needs no memory. Pure.
class PoseThinning {
 public:
  static constexpr std::int64_t kStood = 60'000'000;   ///< us
  static constexpr std::int64_t kSpacing = 1'000'000;  ///< us
  static constexpr double kPlace = 0.03;               ///< m

  /// Of the next pose, at `position` (m in map): whether it is kept.
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
    std::int64_t since, kept;  // us: there, and the last pose that was
  };
  std::optional<Place> place_;
};

}  // namespace curbstone::mapper::journal
