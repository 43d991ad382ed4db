#pragma once

#include <cstdint>

#include "tools/bench/curbs/drive_tiles.hpp"
#include "tools/evaluate/truth.hpp"

namespace curbstone {

/// The demo: a drive round a block of a town made from the seed.
struct TownDrive {
  DriveTiles made;
  Truth truth;
};
[[nodiscard]] TownDrive drive_town(std::uint64_t seed, double seconds);

/// A recorded street (KITTI scans with poses) through the emulated RS16, at the recording's own pace. Truth: its
/// labels.
[[nodiscard]] TownDrive drive_recorded(const std::string& folder, std::uint64_t seed);

}  // namespace curbstone
