#pragma once

#include <string>

#include "tools/evaluate/truth/street_labels.hpp"

namespace curbstone::evaluate::truth {

/// Whether a street has hand-clicked curbs: `folder`/curbs.csv.
[[nodiscard]] bool has_clicked_curbs(const std::string& folder);

/// Reads the curbs of `folder`/curbs.csv as polylines: rows of line,x,y,z,height,dropped as `curbstone simulate` writes
/// them, or only line,x,y, for curbs of unknown height. In m in the lidar frame of the first scan, which
/// `T_world_first` transforms to the truth's frame. A clicked line asserts that there is no other curb up to 3 m beside
/// it; beyond that, and beyond its ends, nothing is known. Throws std::runtime_error with a one-line message.
[[nodiscard]] StreetLabels read_clicked_curbs(const std::string& folder, const Pose& T_world_first);

}  // namespace curbstone::evaluate::truth
