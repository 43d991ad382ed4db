#pragma once

#include <cstdint>

#include "common/geometry/geometry.hpp"

namespace curbstone::mapper {

/// Since when the vehicle has been standing, by the poses that the map gives it.
struct Standstill {
  std::int64_t began = 0;              ///< us, end of the drive's first scan
  std::int64_t since = 0;              ///< us, end of the scan that showed it moving last, else of the first
  Pose T_map_base = Pose::Identity();  ///< then
  bool has_moved = false;              ///< since the drive began

  /// Where a drive begins.
  [[nodiscard]] static Standstill at(std::int64_t utime, const Pose& T_map_base) {
    return {utime, utime, T_map_base, false};
  }
  /// What another scan makes of it.
  [[nodiscard]] Standstill after(std::int64_t utime, const Pose& T_map_now) const {
    const Pose moved = T_map_base.inverse() * T_map_now;
    if (moved.translation().norm() <= 0.05 && angle_of(moved) <= 0.01) return *this;
    return {began, utime, T_map_now, true};
  }
  /// The same after the map was moved.
  [[nodiscard]] Standstill corrected(const Pose& T_new_old) const {
    return {began, since, normalised(T_new_old * T_map_base), has_moved};
  }
};

}  // namespace curbstone::mapper
