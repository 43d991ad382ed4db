#pragma once

#include <string>
#include <vector>

#include "services/semantic_map/map_types.hpp"

namespace curbstone {

/// What a planner wants to know of a whole curb line.
struct CurbSummary {
  double height = 0;            ///< m, median along the line
  bool is_low = false;          ///< dropped, or lower than what counts as high
  bool high_side_left = false;  ///< seen along the line
};

inline constexpr double kHighCurb = 0.05;     ///< m: from here on a curb is `high` unless told otherwise
inline constexpr float kFarthestCurb = 1e5F;  ///< m from the map's origin: farther is no drive

[[nodiscard]] CurbSummary summarise(const CurbLine& line, double high_curb);

/// Those with two points or more, none of them out of reach. The rest is of no use to anybody.
[[nodiscard]] std::vector<CurbLine> usable_curbs(std::vector<CurbLine> lines);

}  // namespace curbstone
