#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "common/tiles/vector_memory.hpp"
#include "services/tensor_voting/kernels/tensor.hpp"
#include "services/tensor_voting/kernels/vote_kernel.hpp"
#include "services/tensor_voting/voting/voxel_table.hpp"

namespace curbstone::tensor_voting::voting {

/// The voters of a tile in blocks; all voters of a block are of one cell. The blocks of one column of cells are
/// chained. The links are stored apart from the blocks, so that following a chain does not wait for each block to be
/// loaded from memory.
///
/// An inactive tile may sleep: it then keeps each voter's position and received votes, but no blocks.
struct VoterTile {
  struct Block {
    kernels::VoterBlock voters;
    kernels::SettledSums settled;
  };
  struct Link {
    int layer;  ///< height index of the cell
    std::int32_t next;
  };
  /// The position of a voter in the blocks.
  struct VoterSlot {
    std::uint32_t number;  ///< counted lane by lane, block by block
    static VoterSlot at(std::uint32_t block, std::size_t lane) {
      return {block * kernels::kLanes + static_cast<std::uint32_t>(lane)};
    }
    [[nodiscard]] std::uint32_t block() const { return number / kernels::kLanes; }
    [[nodiscard]] std::uint32_t lane() const { return number % kernels::kLanes; }
  };
  static constexpr std::size_t kBlocksPerChunk = 4;
  using Chunk = std::array<Block, kBlocksPerChunk>;

  VoterTile(std::int32_t z, std::size_t num_columns) : z_origin(z), columns(num_columns, -1) {}

  std::int32_t z_origin;
  std::vector<std::uint32_t> voter_of_point;
  std::vector<VoterSlot> slots;  ///< of each voter
  std::vector<std::uint32_t> point_of_voter;
  std::vector<std::int32_t> columns;  ///< first block of each, or -1
  std::vector<Link> links;            ///< of each block
  std::vector<std::int64_t> changed;  ///< of each block: VotingField::change() of the last change to its votes
  std::vector<std::array<std::uint32_t, kernels::kLanes>> voters;  ///< of each block, lane by lane
  std::vector<std::unique_ptr<Chunk>> chunks;                      ///< blocks do not move in memory
  VoxelTable voxels;
  std::int64_t num_votes = 0;
  struct SleepingVoter {
    kernels::StepPoint at;
    kernels::VoteSums sums;
  };
  std::vector<SleepingVoter> sleeping_voters;  ///< of each voter; empty unless asleep
  bool asleep = false;

  [[nodiscard]] Block& block(std::size_t i) const { return (*chunks[i / kBlocksPerChunk])[i % kBlocksPerChunk]; }

  /// A block with a free lane for the cell at height index `z` of a column; made if there is none.
  std::uint32_t block_for(std::size_t column, int z) {
    for (std::int32_t i = columns[column]; i >= 0; i = links[static_cast<std::size_t>(i)].next) {
      const auto index = static_cast<std::size_t>(i);
      if (links[index].layer == z && block(index).voters.num_voters < kernels::kLanes)
        return static_cast<std::uint32_t>(i);
    }
    const std::size_t made = links.size();
    if (made % kBlocksPerChunk == 0) chunks.push_back(std::make_unique<Chunk>());
    make_room(1, links);
    links.push_back({z, columns[column]});
    make_room(1, changed);
    changed.push_back(0);
    make_room(1, voters);
    voters.emplace_back();
    columns[column] = static_cast<std::int32_t>(made);
    return static_cast<std::uint32_t>(made);
  }

  /// Frees what only voting needs: the blocks, in which many lanes are empty, and the voxels.
  void sleep() {
    if (asleep) return;
    asleep = true;
    sleeping_voters.reserve(slots.size());
    for (const VoterSlot& slot : slots) {
      const Block& from = block(slot.block());
      sleeping_voters.push_back(
          {from.voters.at(slot.lane()), kernels::sums_of(from.voters, from.settled, slot.lane())});
    }
    release_memory(chunks);
    release_memory(voters);
    voxels = VoxelTable();
    voter_of_point.shrink_to_fit();
    slots.shrink_to_fit();
    point_of_voter.shrink_to_fit();
    links.shrink_to_fit();
    changed.shrink_to_fit();
  }
  /// Restores exactly the same bits. voxel_of(place): the voxel of a voter at that place.
  template <class VoxelOf>
  void wake(const VoxelOf& voxel_of) {
    if (!asleep) return;
    asleep = false;
    chunks.resize((links.size() + kBlocksPerChunk - 1) / kBlocksPerChunk);
    for (std::unique_ptr<Chunk>& chunk : chunks) chunk = std::make_unique<Chunk>();
    voters.resize(links.size());
    // In each block, too, the first voter has the first lane.
    for (std::uint32_t i = 0; i < sleeping_voters.size(); ++i) {
      const SleepingVoter& from = sleeping_voters[i];
      Block& to = block(slots[i].block());
      const std::size_t lane = to.voters.push_back(from.at);
      kernels::set_sums(from.sums, to.voters, to.settled, lane);
      voters[slots[i].block()][lane] = i;
      voxels.find_or_insert(voxel_of(from.at));
    }
    release_memory(sleeping_voters);
  }

  /// The votes that each voter has received.
  [[nodiscard]] std::vector<kernels::VoteSums> sums() const {
    std::vector<kernels::VoteSums> result;
    result.reserve(slots.size());
    for (const SleepingVoter& sleeping : sleeping_voters) result.push_back(sleeping.sums);
    if (asleep) return result;
    for (const VoterSlot& slot : slots) {
      const Block& at = block(slot.block());
      result.push_back(kernels::sums_of(at.voters, at.settled, slot.lane()));
    }
    return result;
  }
};

}  // namespace curbstone::tensor_voting::voting
