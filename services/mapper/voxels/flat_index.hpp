#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace curbstone::mapper::voxels {

/// Key of a voxel: its lattice coordinates, 21 bits each, in one word. 2^20 voxels of 5 cm reach 52 km either way.
using VoxelKey = std::uint64_t;
inline constexpr std::int32_t kVoxelLimit = 1 << 20;

[[nodiscard]] inline VoxelKey voxel_key(const Eigen::Vector3i& cell) {
  const auto part = [](int v) { return static_cast<std::uint64_t>(v + kVoxelLimit) & 0x1fffff; };
  return (part(cell.x()) << 42) | (part(cell.y()) << 21) | part(cell.z());
}

/// Rounds down. Without SSE4.1, which not every machine has, std::floor() is a function call.
[[nodiscard]] inline int floor_to_int(double v) {
  const int towards_zero = static_cast<int>(v);
  return towards_zero - (v < towards_zero ? 1 : 0);
}

/// The lattice cell of a point. The point must be within the lattice: |coordinate| * inverse_size < kVoxelLimit.
template <class Vector>
[[nodiscard]] Eigen::Vector3i voxel_of(const Vector& point, double inverse_size) {
  return {floor_to_int(static_cast<double>(point.x()) * inverse_size),
          floor_to_int(static_cast<double>(point.y()) * inverse_size),
          floor_to_int(static_cast<double>(point.z()) * inverse_size)};
}

/// Hash map from voxel keys to indices into the caller's array: open addressing, linear probing. It cannot be iterated,
/// so no result can depend on the order of its slots.
class FlatIndex {
 public:
  static constexpr std::uint32_t kNone = 0xffffffff;

  explicit FlatIndex(std::size_t expected = 1024) { clear(expected); }

  void clear(std::size_t expected) {
    std::size_t capacity = 16;
    while (capacity < 2 * expected) capacity *= 2;
    slots_.assign(capacity, Slot{});
    size_ = 0;
  }

  [[nodiscard]] std::uint32_t find(VoxelKey key) const {
    for (std::size_t i = home(key);; i = next(i)) {
      if (slots_[i].value == kNone) return kNone;
      if (slots_[i].key == key) return slots_[i].value;
    }
  }

  /// The slot at which a search for the key begins, to be prefetched. (To GCC a function that only prefetches has no
  /// effect: it drops the calls.)
  [[nodiscard]] const void* begin_of_search(VoxelKey key) const { return &slots_[home(key)]; }

  /// Returns the key's value; if it has none, stores `value` and returns kNone.
  std::uint32_t find_or_insert(VoxelKey key, std::uint32_t value) {
    if (2 * (size_ + 1) > slots_.size()) grow();
    std::size_t i = home(key);
    for (; slots_[i].value != kNone; i = next(i)) {
      if (slots_[i].key == key) return slots_[i].value;
    }
    slots_[i] = {key, value};
    ++size_;
    return kNone;
  }

  /// Removes the key if it is present. Entries behind it move up, so that searches do not get longer.
  void erase(VoxelKey key) {
    std::size_t hole = home(key);
    while (slots_[hole].value != kNone && slots_[hole].key != key) hole = next(hole);
    if (slots_[hole].value == kNone) return;
    const std::size_t mask = slots_.size() - 1;
    for (std::size_t i = next(hole); slots_[i].value != kNone; i = next(i)) {
      const std::size_t searched = (i - home(slots_[i].key)) & mask;
      if (searched < ((i - hole) & mask)) continue;  // its home slot is behind the hole
      slots_[hole] = slots_[i];
      hole = i;
    }
    slots_[hole].value = kNone;
    --size_;
  }

  [[nodiscard]] std::size_t size() const { return size_; }

  /// Fibonacci hashing, then the high bits are folded down: use the low ones.
  [[nodiscard]] static std::size_t hash(VoxelKey key) {
    const std::uint64_t h = key * 0x9e3779b97f4a7c15ULL;
    return static_cast<std::size_t>(h ^ (h >> 32));
  }

 private:
  struct Slot {
    VoxelKey key = 0;
    std::uint32_t value = kNone;
  };

  [[nodiscard]] std::size_t home(VoxelKey key) const { return hash(key) & (slots_.size() - 1); }
  [[nodiscard]] std::size_t next(std::size_t i) const { return (i + 1) & (slots_.size() - 1); }

  void grow() {
    std::vector<Slot> old(slots_.size() * 2);
    old.swap(slots_);
    for (const Slot& slot : old) {
      if (slot.value == kNone) continue;
      std::size_t i = home(slot.key);
      while (slots_[i].value != kNone) i = next(i);
      slots_[i] = slot;
    }
  }

  std::vector<Slot> slots_;
  std::size_t size_ = 0;
};

}  // namespace curbstone::mapper::voxels
