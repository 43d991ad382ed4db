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

/// What is out of a tile: what the next step goes on from. As it begins: nothing.
struct VotedBase {
  struct Scale {
    std::int64_t change = 0;  ///< VotingField::change()
    /// Of the sums that are out: block by block, voter by voter.
    std::vector<std::array<std::uint64_t, kernels::kLanes>> digests;
  };
  std::int32_t revision = 0;
  std::size_t num_points = 0;
  std::vector<Scale> scales;  ///< empty: not known any more; then all sums are others
};

/// The step from `base` to a tile as it is, as VOTED_POINTS messages of at most kMaxPageBytes: its new points, in the
/// mapper's order, and the decomposed tensors of each field's scale that have become others. At least one message.
/// `base` becomes that of the step after it.
[[nodiscard]] std::vector<voted_points_t> make_voted_pages(TileKey key, const PointTile& tile, std::int32_t revision,
                                                           VotedBase& base,
                                                           std::span<const voting::VotingField> fields);

inline constexpr std::size_t kMaxPageBytes = 48'000;

}  // namespace curbstone::tensor_voting::worker
