#pragma once

#include <cstdint>
#include <curbstone/voted_points_t.hpp>
#include <span>
#include <vector>

#include "common/tile.hpp"
#include "services/tensor_voting/point_tiles.hpp"
#include "services/tensor_voting/voting_field.hpp"

namespace curbstone {

/// One complete revision of a tile as VOTED_POINTS messages of at most kMaxPageBytes: its points, in the mapper's
/// order, with the decomposed tensors of each field's scale.
[[nodiscard]] std::vector<voted_points_t> make_voted_pages(TileKey key, const PointTile& tile, std::int32_t epoch,
                                                           std::int32_t revision, std::int64_t utime,
                                                           std::span<const VotingField> fields);

inline constexpr std::size_t kMaxPageBytes = 48'000;

}  // namespace curbstone
