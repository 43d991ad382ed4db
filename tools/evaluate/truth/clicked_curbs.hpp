#pragma once

#include <string>

#include "tools/evaluate/truth/street_labels.hpp"

namespace curbstone::evaluate::truth {

/// Whether somebody clicked the curbs of a street: `folder`/curbs.csv.
[[nodiscard]] bool has_clicked_curbs(const std::string& folder);

/// Curbs as polylines of `folder`/curbs.csv: rows of line,x,y,z,height,dropped as `curbstone simulate` writes them, or
/// line,x,y alone, which are curbs of unknown height. In m in the lidar frame of the first scan, which
/// `T_world_first` takes to the truth's frame. Who clicked a line says that there is no other curb up to 3 m beside it;
/// beyond, and beyond its ends, nothing is known. Throws std::runtime_error with one clear line.
[[nodiscard]] StreetLabels read_clicked_curbs(const std::string& folder, const Pose& T_world_first);

}  // namespace curbstone::evaluate::truth
