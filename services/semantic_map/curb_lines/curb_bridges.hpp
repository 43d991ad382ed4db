#pragma once

#include <vector>

#include "services/semantic_map/curb_lines/lowered_step.hpp"
#include "services/semantic_map/tile/map_types.hpp"

namespace curbstone::semantic_map::curb_lines {

/// Puts behind `lines` what lies between two of them, at most 8 m apart, of which each goes on where the other points
/// to, with the higher side on the same side, and where no other line lies:
///
/// - a lowered kerb (`dropped`), where the ground was seen on both sides and steps up along the whole bridge
///   (find_lowered_step()): too low to be found without knowing where it is;
/// - a curb that nobody saw (`inferred`), as behind a parked vehicle: between lines of one height, not lowered where
///   they end. Not where the ground was seen on both sides of the bridge without a step (a driveway, an open road).
///
/// A bridge begins and ends at vertices of lines; its confidence is half of the less certain one's. `lines`: the high
/// side on the right; ids go on from their number. The same lines and the same ground give the same bridges.
void add_bridges(const SeenGround& ground, std::vector<tile::CurbLine>& lines);

/// Where `lines`, with their bridges, still go on where another points to, at most 8 m on, with nothing in between that
/// is long enough to point anywhere: there the ground was seen without a step. At a driveway the kerbstones lie flush
/// there. No curbs: only places, with the high side that the lines have and no confidence. Where a curb is cut
/// because a part of it is lowered, the whole of it says where its end points.
[[nodiscard]] std::vector<tile::CurbLine> flush_kerbs(const std::vector<tile::CurbLine>& lines);

}  // namespace curbstone::semantic_map::curb_lines
