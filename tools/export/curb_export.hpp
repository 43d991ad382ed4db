#pragma once

#include <string>
#include <vector>

#include "services/semantic_map/curb_lines/curb_rise.hpp"
#include "services/semantic_map/tile/driven_path.hpp"
#include "services/semantic_map/tile/map_types.hpp"

namespace curbstone::map_export {

/// What a planner wants to know of a whole curb line.
struct CurbSummary {
  double height = 0;            ///< m, median along the line
  bool is_low = false;          ///< dropped, or lower than what counts as high
  bool high_side_left = false;  ///< seen along the line
  semantic_map::curb_lines::CurbRise rise = semantic_map::curb_lines::CurbRise::kUnknown;
};

inline constexpr double kHighCurb = 0.05;     ///< m: from here on a curb is `high` unless given otherwise
inline constexpr float kFarthestCurb = 1e5F;  ///< m from the map's origin: farther is no drive

/// What curbs are looked at with.
struct CurbView {
  double high_curb = kHighCurb;              ///< m
  semantic_map::tile::DrivenPath path = {};  ///< a curb rises or falls for whoever comes from there
};

[[nodiscard]] CurbSummary summarise(const semantic_map::tile::CurbLine& line, const CurbView& view);
/// "up", "down", "unknown".
[[nodiscard]] std::string rise_name(semantic_map::curb_lines::CurbRise rise);

/// Those with two points or more, none of them out of reach. The rest is of no use to anybody.
[[nodiscard]] std::vector<semantic_map::tile::CurbLine> usable_curbs(std::vector<semantic_map::tile::CurbLine> lines);

}  // namespace curbstone::map_export
