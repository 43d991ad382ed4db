#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "services/tensor_voting/kernels/tensor.hpp"
#include "services/tensor_voting/kernels/vote_kernel.hpp"
#include "services/tensor_voting/voting/voxel_table.hpp"

namespace curbstone::tensor_voting::voting {

/// The voters of a tile in blocks; a block's are of one cell. The blocks of one column of cells are chained, apart from
/// the blocks themselves: a walk along a chain must not wait for each of them to come from memory.
struct VoterTile {
  struct Block {
    kernels::VoterBlock voters;
    kernels::SettledSums settled;
  };
  struct Link {
    int layer;  ///< height index of the cell
    std::int32_t next;
  };
  /// Where a voter stands.
  struct Seat {
    std::uint32_t block;
    std::uint32_t lane;
  };
  static constexpr std::size_t kBlocksPerChunk = 8;
  using Chunk = std::array<Block, kBlocksPerChunk>;

  VoterTile(std::int32_t z, std::size_t num_columns) : z_origin(z), columns(num_columns, -1) {}

  std::int32_t z_origin;
  std::vector<std::uint32_t> voter_of_point;
  std::vector<Seat> seats;  ///< of each voter
  std::vector<std::uint32_t> point_of_voter;
  std::vector<std::int32_t> columns;  ///< first block of each, or -1
  std::vector<Link> links;            ///< of each block
  std::vector<std::int64_t> changed;  ///< of each block: VotingField::change() that touched its votes last
  std::vector<std::array<std::uint32_t, kernels::kLanes>> voters;  ///< of each block, lane by lane
  std::vector<std::unique_ptr<Chunk>> chunks;                      ///< blocks stay where they are
  VoxelTable voxels;
  std::int64_t num_votes = 0;

  [[nodiscard]] Block& block(std::size_t i) const { return (*chunks[i / kBlocksPerChunk])[i % kBlocksPerChunk]; }

  /// A block with a lane left for the cell at height index `z` of a column; made if there is none.
  std::uint32_t block_for(std::size_t column, int z) {
    for (std::int32_t i = columns[column]; i >= 0; i = links[static_cast<std::size_t>(i)].next) {
      const auto index = static_cast<std::size_t>(i);
      if (links[index].layer == z && block(index).voters.num_voters < kernels::kLanes)
        return static_cast<std::uint32_t>(i);
    }
    const std::size_t made = links.size();
    if (made % kBlocksPerChunk == 0) chunks.push_back(std::make_unique<Chunk>());
    links.push_back({z, columns[column]});
    changed.push_back(0);
    voters.emplace_back();
    columns[column] = static_cast<std::int32_t>(made);
    return static_cast<std::uint32_t>(made);
  }

  /// What each voter has received.
  [[nodiscard]] std::vector<kernels::VoteSums> sums() const {
    std::vector<kernels::VoteSums> result;
    result.reserve(seats.size());
    for (const Seat& seat : seats) {
      const Block& at = block(seat.block);
      result.push_back(kernels::sums_of(at.voters, at.settled, seat.lane));
    }
    return result;
  }
};

}  // namespace curbstone::tensor_voting::voting
