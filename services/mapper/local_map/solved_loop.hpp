#pragma once

#include <memory>
#include <optional>

#include "common/geometry/geometry.hpp"
#include "services/mapper/local_map/local_map.hpp"
#include "services/mapper/pose_graph/atlas.hpp"
#include "services/mapper/pose_graph/loop_closer.hpp"
#include "services/mapper/registration/registration.hpp"

namespace curbstone::mapper::local_map {

/// What a closed loop changes.
struct SolvedLoop {
  std::optional<pose_graph::LoopCorrection> correction;  ///< nothing: the loop contradicts the drive
  std::optional<NewLocalMap> local_map;                  ///< nothing: the correction is too small to move the map
};

/// Solves the graph with the loop, and builds the local map that the corrected drive has. The vehicle is at
/// T_map_base. `atlas`: a copy, so that scans go on meanwhile; `empty`: the registration map to fill. Pure.
[[nodiscard]] SolvedLoop solve_loop(pose_graph::Atlas atlas, const pose_graph::LoopCloser& closer,
                                    const pose_graph::LoopClosure& closure, const Pose& T_map_base,
                                    std::unique_ptr<registration::Registration> empty);

}  // namespace curbstone::mapper::local_map
