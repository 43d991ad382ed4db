#pragma once

#include <cstdint>

#include "services/semantic_map/tile/driven_path.hpp"
#include "services/semantic_map/tile/map_types.hpp"

namespace curbstone::semantic_map::curb_lines {

/// Whether a vehicle that comes from the path steps up or down at the curb. The values of curb_line_t.
enum class CurbRise : std::int8_t { kUnknown = 0, kUp = 1, kDown = -1 };
[[nodiscard]] CurbRise seen_from(const tile::CurbLine& line, const tile::DrivenPath& path);

}  // namespace curbstone::semantic_map::curb_lines
