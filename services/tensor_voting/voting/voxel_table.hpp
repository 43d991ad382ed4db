#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace curbstone::tensor_voting::voting {

/// Who came first to each voxel: an open-addressing hash from voxel to index. No removal; 12 bytes a slot.
class VoxelTable {
 public:
  /// A voxel in a place of its own lattice; each coordinate within 21 bits.
  static std::uint64_t key(std::int64_t x, std::int64_t y, std::int64_t z) {
    const auto bits = [](std::int64_t v) { return static_cast<std::uint64_t>(v) & 0x1fffff; };
    return bits(x) << 42 | bits(y) << 21 | bits(z);
  }

  /// The index that holds voxel `key`; if there is none yet, `index` takes it.
  std::uint32_t find_or_insert(std::uint64_t key, std::uint32_t index) {
    if (2 * (size_ + 1) > keys_.size()) grow();
    const std::size_t slot = slot_of(key);
    if (indices_[slot] == kFree) {
      keys_[slot] = key;
      indices_[slot] = index;
      ++size_;
    }
    return indices_[slot];
  }

 private:
  static constexpr std::uint32_t kFree = 0xffffffff;

  [[nodiscard]] std::size_t slot_of(std::uint64_t key) const {
    std::uint64_t h = key * 0x9e3779b97f4a7c15ULL;
    h ^= h >> 32;
    const std::size_t mask = keys_.size() - 1;
    std::size_t slot = h & mask;
    while (indices_[slot] != kFree && keys_[slot] != key) slot = (slot + 1) & mask;
    return slot;
  }

  void grow() {
    const std::vector<std::uint64_t> keys = std::exchange(keys_, {});
    const std::vector<std::uint32_t> indices = std::exchange(indices_, {});
    keys_.resize(keys.empty() ? 32 : 2 * keys.size());
    indices_.assign(keys_.size(), kFree);
    for (std::size_t i = 0; i < keys.size(); ++i) {
      if (indices[i] == kFree) continue;
      const std::size_t slot = slot_of(keys[i]);
      keys_[slot] = keys[i];
      indices_[slot] = indices[i];
    }
  }

  std::vector<std::uint64_t> keys_;
  std::vector<std::uint32_t> indices_;
  std::size_t size_ = 0;
};

}  // namespace curbstone::tensor_voting::voting
