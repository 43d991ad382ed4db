#pragma once

#include <vector>

#include "services/semantic_map/curb_lines/lowered_step.hpp"
#include "services/semantic_map/tile/map_types.hpp"

namespace curbstone::semantic_map::curb_lines {

/// Appends bridges to `lines`: in gaps of at most 8 m between two lines that point at each other, with the higher side
/// on the same side, and with no other line in between:
///
/// - a lowered kerb (`dropped`), if the ground was seen on both sides and steps up along the whole bridge
///   (find_lowered_step()): too low to be found without knowing its place;
/// - an unseen curb (`inferred`), as behind a parked vehicle: between lines of equal height that are not lowered at the
///   gap. Not if the ground was seen on both sides of the bridge without a step (a driveway, an open road).
///
/// A bridge begins and ends at vertices of lines; its confidence is half of the less certain line's. `lines`: the high
/// side on the right; ids of bridges continue their numbering. The same lines and ground give the same bridges.
void add_bridges(const SeenGround& ground, std::vector<tile::CurbLine>& lines);

/// The gaps that remain between `lines`, with their bridges: at most 8 m, between two lines that point at each other,
/// with nothing in between that is long enough to have a direction. There the ground was seen without a step, as at a
/// driveway with flush kerbstones. The results are not curbs, but places, with the high side of the lines and no
/// confidence. If a curb is cut because a part of it is lowered, the direction at its end is computed from the whole
/// curb.
[[nodiscard]] std::vector<tile::CurbLine> flush_kerbs(const std::vector<tile::CurbLine>& lines);

}  // namespace curbstone::semantic_map::curb_lines
