#pragma once

#include <array>
#include <cstdint>
#include <curbstone/voted_points_t.hpp>
#include <span>
#include <vector>

#include "common/tiles/tile.hpp"
#include "services/tensor_voting/voting/voting_field.hpp"
#include "services/tensor_voting/worker/point_tiles.hpp"

namespace curbstone::tensor_voting::worker {

/// The published state of a tile: the base of the next delta. Initially empty.
struct VotedBase {
  struct Scale {
    std::int64_t change = 0;  ///< VotingField::change()
    /// Digests of the published sums: block by block, voter by voter.
    std::vector<std::array<std::uint64_t, kernels::kLanes>> digests;
  };
  std::int32_t revision = 0;
  std::size_t num_points = 0;
  std::vector<Scale> scales;  ///< empty: not known any more; the next delta then contains all tensors
};

/// Makes the delta from `base` to a tile's present state, as VOTED_POINTS messages of at most kMaxPageBytes: its new
/// points, in the mapper's order, and the changed tensors of each field's scale, decomposed. Returns at least one
/// message. Updates `base` to the present state.
[[nodiscard]] std::vector<voted_points_t> make_voted_pages(TileKey key, const PointTile& tile, std::int32_t revision,
                                                           VotedBase& base,
                                                           std::span<const voting::VotingField> fields);

inline constexpr std::size_t kMaxPageBytes = 48'000;

}  // namespace curbstone::tensor_voting::worker
