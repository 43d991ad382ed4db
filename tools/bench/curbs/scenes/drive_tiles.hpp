#pragma once

#include "tools/bench/curbs/scenes/voted_log.hpp"
#include "tools/simulate/rig/drive.hpp"

namespace curbstone::bench::curbs::scenes {

/// Emulates the drive through drivers, filter, mapper and one voting worker in this process. Writes and removes a log
/// in the temporary folder. Throws std::runtime_error if that cannot be written.
[[nodiscard]] DriveTiles drive_tiles(const simulate::rig::Drive& drive);

/// T_world_base at 20 Hz.
[[nodiscard]] evaluate::truth::Trajectory true_trajectory(const simulate::rig::Drive& drive);

}  // namespace curbstone::bench::curbs::scenes
