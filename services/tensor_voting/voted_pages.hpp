#pragma once

#include <cstdint>
#include <curbstone/voted_points_t.hpp>
#include <span>
#include <vector>

#include "common/tile.hpp"
#include "services/tensor_voting/point_tiles.hpp"
#include "services/tensor_voting/voting_field.hpp"

namespace curbstone {

/// What is out of a tile: what the next step goes on from. As it begins: nothing.
struct VotedBase {
  std::int32_t revision = 0;
  std::size_t num_points = 0;
  std::vector<std::int64_t> changes;  ///< VotingField::change() of each field
};

/// The step from `base` to a tile as it is, as VOTED_POINTS messages of at most kMaxPageBytes: its new points, in the
/// mapper's order, and the decomposed tensors of each field's scale that may have become others. At least one message.
[[nodiscard]] std::vector<voted_points_t> make_voted_pages(TileKey key, const PointTile& tile, std::int32_t revision,
                                                           const VotedBase& base, std::span<const VotingField> fields);
/// Those pages' successor's base.
[[nodiscard]] VotedBase make_voted_base(const PointTile& tile, std::int32_t revision,
                                        std::span<const VotingField> fields);

inline constexpr std::size_t kMaxPageBytes = 48'000;

}  // namespace curbstone
