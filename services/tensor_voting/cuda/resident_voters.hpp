#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "services/tensor_voting/cuda/cell_grid.hpp"
#include "services/tensor_voting/cuda/field_votes.hpp"

namespace curbstone::tensor_voting::cuda {

/// The voters of a map and the votes they have received, kept on a machine in the order of their keys. All functions
/// throw std::runtime_error when the machine fails. They allocate memory before they change anything.
class ResidentVoters {
 public:
  virtual ~ResidentVoters() = default;

  /// Adds voters, with their keys. Returns for each of `num_slots` tiles whether its sums have changed.
  virtual std::vector<std::uint8_t> add(const std::vector<std::uint64_t>& keys,
                                        const std::vector<ResidentVoter>& voters, std::uint32_t num_slots) = 0;
  /// Removes all `count` voters of the tiles marked by slot. Returns the same as add().
  virtual std::vector<std::uint8_t> remove(const std::vector<std::uint8_t>& tiles, std::uint32_t count) = 0;
  /// The sums of `total` voters of some tiles: a tile's from offsets[slot] on, in the order of their numbers; offset
  /// kUnwanted leaves a tile out.
  static constexpr std::uint32_t kUnwanted = 0xffffffff;
  virtual std::vector<ResidentSums> sums(const std::vector<std::uint32_t>& offsets, std::uint32_t total) = 0;
  virtual void clear() = 0;
};

}  // namespace curbstone::tensor_voting::cuda
