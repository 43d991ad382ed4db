#pragma once

#include <string>
#include <vector>

#include "services/semantic_map/tile/voted_tile.hpp"
#include "tools/evaluate/truth/trajectory.hpp"

namespace curbstone::bench::curbs::scenes {

/// The result of the stack up to the vote for a drive: the last revision of every tile, and the mapper's poses.
struct DriveTiles {
  std::vector<semantic_map::tile::VotedTile> tiles;  ///< by key
  evaluate::truth::Trajectory trajectory;            ///< T_map_base
};

/// Feeds a log of the drivers' messages to the filter, the mapper and one voting worker. Throws std::runtime_error if
/// the log cannot be read.
[[nodiscard]] DriveTiles vote_log(const std::string& log);

}  // namespace curbstone::bench::curbs::scenes
