#pragma once

#include "tools/bench/curbs/voted_log.hpp"
#include "tools/simulate/drive.hpp"

namespace curbstone {

/// Emulates the drive through the drivers, the filter, the mapper and one voting worker, in this process. Uses (and
/// removes) a log in the temporary folder. Throws std::runtime_error when that cannot be written.
[[nodiscard]] DriveTiles drive_tiles(const Drive& drive);

/// T_world_base at 20 Hz.
[[nodiscard]] Trajectory true_trajectory(const Drive& drive);

}  // namespace curbstone
