#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <curbstone/curb_lines_t.hpp>
#include <curbstone/map_trajectory_t.hpp>
#include <curbstone/marking_line_t.hpp>
#include <curbstone/semantic_tile_t.hpp>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "services/semantic_map/curb_lines/curb_rise.hpp"
#include "services/semantic_map/tile/map_types.hpp"

namespace curbstone::semantic_map {

/// `path`: as driven, m in map; it determines the sign of the rise.
[[nodiscard]] curb_line_t to_message(const tile::CurbLine& line, const tile::DrivenPath& path);
[[nodiscard]] marking_line_t to_message(const tile::MarkingLine& line);
[[nodiscard]] semantic_tile_t to_message(const tile::MapTile& tile, std::int32_t epoch, std::int32_t revision);
/// One pose of a page of the drive; its values are not checked.
[[nodiscard]] Pose pose_of(const map_trajectory_t& page, std::size_t i);

}  // namespace curbstone::semantic_map
