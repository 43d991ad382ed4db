#pragma once

#include <cstddef>
#include <cstdint>

#include "common/tiles/tile.hpp"

namespace curbstone {

/// @file
/// The drive as versioned state. MAP_POSE messages can be lost like any other message. The mapper's poses of an epoch
/// are therefore divided into pages of ten seconds of message time, which TILE_INDEX announces and TILE_REQUEST
/// requests, as they do for tiles. A page's key is its time, its version the number of its poses.

inline constexpr const char* kDriveChannel = "MAP_TRAJECTORY";
inline constexpr std::int64_t kDrivePage = 10'000'000;  ///< us
inline constexpr std::int32_t kPageAgain = -1;          ///< map_trajectory_t.page of a page that was requested

/// The page of a pose at `utime`, us, not negative.
[[nodiscard]] inline TileKey drive_page(std::int64_t utime) {
  return {static_cast<std::int32_t>(utime / kDrivePage), 0};
}

inline constexpr std::size_t kMaxPosesPerPage = 800;  ///< 42 kB: one message; further poses are not repeated

}  // namespace curbstone
