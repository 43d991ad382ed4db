#pragma once

#include <cstdint>

#include "common/geometry/geometry.hpp"

namespace curbstone::mapper {

/// Since when the vehicle has been standing, judged by its poses in map.
struct Standstill {
  std::int64_t began = 0;              ///< us, end of the drive's first scan
  std::int64_t since = 0;              ///< us, end of the last scan that showed motion, else of the first scan
  Pose T_map_base = Pose::Identity();  ///< at `since`
  bool has_moved = false;              ///< since the drive began

  /// The state at the first scan of a drive.
  [[nodiscard]] static Standstill at(std::int64_t utime, const Pose& T_map_base) {
    return {utime, utime, T_map_base, false};
  }
  /// The state after another scan. Motion: more than 5 cm or 0.01 rad from T_map_base.
  [[nodiscard]] Standstill after(std::int64_t utime, const Pose& T_map_now) const {
    const Pose moved = T_map_base.inverse() * T_map_now;
    if (moved.translation().norm() <= 0.05 && angle_of(moved) <= 0.01) return *this;
    return {began, utime, T_map_now, true};
  }
  /// The same state after the map was moved by T_new_old.
  [[nodiscard]] Standstill corrected(const Pose& T_new_old) const {
    return {began, since, normalised(T_new_old * T_map_base), has_moved};
  }
};

}  // namespace curbstone::mapper
