#pragma once

#include <cstdint>

#include "tools/bench/curbs/scenes/drive_tiles.hpp"
#include "tools/evaluate/truth/truth.hpp"

namespace curbstone::bench::curbs::scenes {

/// A drive and its truth.
struct JudgedDrive {
  DriveTiles made;
  evaluate::truth::Truth truth;
  Pose T_world_first = Pose::Identity();  ///< of a recording's first scan
};
/// The demo: around a block of a town generated from the seed.
[[nodiscard]] JudgedDrive drive_town(std::uint64_t seed, double seconds);

/// A recorded street (KITTI scans with poses) through the emulated RS16, at the recorded speed. Truth: its labels.
[[nodiscard]] JudgedDrive drive_recorded(const std::string& folder, std::uint64_t seed);

}  // namespace curbstone::bench::curbs::scenes
