#pragma once

#include <string>
#include <vector>

#include "services/semantic_map/curb_lines/curb_rise.hpp"
#include "services/semantic_map/tile/driven_path.hpp"
#include "services/semantic_map/tile/map_types.hpp"

namespace curbstone::map_export {

/// Properties of a whole curb line for a planner.
struct CurbSummary {
  double height = 0;            ///< m, median along the line
  bool is_low = false;          ///< dropped, or lower than the threshold of a high curb
  bool high_side_left = false;  ///< seen along the line
  semantic_map::curb_lines::CurbRise rise = semantic_map::curb_lines::CurbRise::kUnknown;
};

inline constexpr double kHighCurb = 0.05;      ///< m: curbs of this height and above are `high` by default
inline constexpr float kMaxCoordinate = 1e5F;  ///< m from the map's origin: farther points are errors

/// How curbs are summarised.
struct CurbView {
  double high_curb = kHighCurb;              ///< m
  semantic_map::tile::DrivenPath path = {};  ///< a curb rises or falls as seen from this path
};

[[nodiscard]] CurbSummary summarise(const semantic_map::tile::CurbLine& line, const CurbView& view);
/// "up", "down", "unknown".
[[nodiscard]] std::string rise_name(semantic_map::curb_lines::CurbRise rise);

/// The lines with two or more points, all of them within kMaxCoordinate.
[[nodiscard]] std::vector<semantic_map::tile::CurbLine> usable_curbs(std::vector<semantic_map::tile::CurbLine> lines);

}  // namespace curbstone::map_export
