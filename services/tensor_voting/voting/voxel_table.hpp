#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/tiles/vector_memory.hpp"

namespace curbstone::tensor_voting::voting {

/// Numbers voxels in the order of their first appearance: an open-addressing hash from voxel to number. No removal; 16
/// to 22 bytes a voxel.
class VoxelTable {
 public:
  /// The key of a voxel from its indices in the caller's lattice; each must fit in 21 bits.
  static std::uint64_t key(std::int64_t x, std::int64_t y, std::int64_t z) {
    const auto bits = [](std::int64_t v) { return static_cast<std::uint64_t>(v) & 0x1fffff; };
    return bits(x) << 42 | bits(y) << 21 | bits(z);
  }

  /// The voxel's number. A new voxel gets the number of voxels present before.
  std::uint32_t find_or_insert(std::uint64_t key) {
    if (2 * (keys_.size() + 1) > slots_.size()) grow();
    std::uint32_t& slot = slots_[slot_of(key)];
    if (slot == kFree) {
      slot = static_cast<std::uint32_t>(keys_.size());
      make_room(1, keys_);
      keys_.push_back(key);
    }
    return slot;
  }

 private:
  static constexpr std::uint32_t kFree = 0xffffffff;

  [[nodiscard]] std::size_t slot_of(std::uint64_t key) const {
    std::uint64_t h = key * 0x9e3779b97f4a7c15ULL;
    h ^= h >> 32;
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = h & mask;
    while (slots_[slot] != kFree && keys_[slots_[slot]] != key) slot = (slot + 1) & mask;
    return slot;
  }

  void grow() {
    const std::size_t size = slots_.empty() ? 32 : 2 * slots_.size();
    release_memory(slots_);
    slots_.assign(size, kFree);
    for (std::uint32_t i = 0; i < keys_.size(); ++i) slots_[slot_of(keys_[i])] = i;
  }

  std::vector<std::uint64_t> keys_;   // of each voxel, by number
  std::vector<std::uint32_t> slots_;  // numbers
};

}  // namespace curbstone::tensor_voting::voting
