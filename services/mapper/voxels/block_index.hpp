#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "services/mapper/voxels/flat_index.hpp"

namespace curbstone::mapper::voxels {

/// Maps the cells of a lattice to indices into the caller's array, by blocks of 4 x 4 x 4 cells: neighbouring cells are
/// mostly found with one search. The caller assigns the indices. Pure; one thread.
class BlockIndex {
 public:
  static constexpr std::uint32_t kNone = FlatIndex::kNone;
  static constexpr int kSide = 4;
  /// The indices of a block's cells; kNone if a cell has none.
  using Places = std::array<std::uint32_t, kSide * kSide * kSide>;

  BlockIndex() { clear(); }

  void clear() {
    blocks_.assign(1, {Eigen::Vector3i::Zero(), kNothing});
    index_.clear(1024);
  }

  [[nodiscard]] std::uint32_t find(const Eigen::Vector3i& cell) const {
    return blocks_[search(block_of(cell))].places[within(cell.x(), cell.y(), cell.z())];
  }

  /// find() in steps, for many cells at a time: where the index is larger than the CPU's caches, the caller prefetches
  /// what the next step reads. begin_of_search() is what block() reads, address_in() what find_in() reads. The number
  /// of a block, 0 if there is none, is valid until erase_blocks() or clear().
  [[nodiscard]] const void* begin_of_search(const Eigen::Vector3i& cell) const {
    return index_.begin_of_search(voxel_key(block_of(cell)));
  }
  [[nodiscard]] std::uint32_t block(const Eigen::Vector3i& cell) const {
    return static_cast<std::uint32_t>(search(block_of(cell)));
  }
  [[nodiscard]] const void* address_in(std::uint32_t block, const Eigen::Vector3i& cell) const {
    return &blocks_[block].places[within(cell.x(), cell.y(), cell.z())];
  }
  [[nodiscard]] std::uint32_t find_in(std::uint32_t block, const Eigen::Vector3i& cell) const {
    return blocks_[block].places[within(cell.x(), cell.y(), cell.z())];
  }

  /// Reference to the cell's index, to be set if it is kNone. Valid until the next call.
  [[nodiscard]] std::uint32_t& place(const Eigen::Vector3i& cell) {
    const Eigen::Vector3i block = block_of(cell);
    const auto next = static_cast<std::uint32_t>(blocks_.size());
    std::uint32_t at = index_.find_or_insert(voxel_key(block), next);
    if (at == kNone) {
      at = next;
      blocks_.push_back({block, kNothing});
    }
    return blocks_[at].places[within(cell.x(), cell.y(), cell.z())];
  }

  /// Looks up a sequence of cells; searches only when the next one is in another block.
  class Finder {
   public:
    explicit Finder(const BlockIndex& index) : index_(index) {}
    [[nodiscard]] std::uint32_t operator()(const Eigen::Vector3i& cell) {
      const Eigen::Vector3i block = block_of(cell);
      if (places_ == nullptr || block != block_) {
        block_ = block;
        places_ = &index_.blocks_[index_.search(block)].places;
      }
      return (*places_)[within(cell.x(), cell.y(), cell.z())];
    }

   private:
    const BlockIndex& index_;
    Eigen::Vector3i block_ = Eigen::Vector3i::Zero();
    const Places* places_ = nullptr;
  };

  /// Calls `visit(place, dx, dy, dz)` for the 3 x 3 x 3 cells around and including `cell` that have an index, in order.
  template <class Visit>
  void around(const Eigen::Vector3i& cell, Visit&& visit) const {
    const Eigen::Vector3i low = cell.array() - 1;
    const Eigen::Vector3i first = block_of(low);
    const Eigen::Vector3i spans = block_of(cell.array() + 1) - first;  // 0 or 1 per axis
    std::array<const Places*, 8> near{};
    for (int i = 0; i < 8; ++i) {
      const Eigen::Vector3i step(i >> 2, (i >> 1) & 1, i & 1);
      if ((step.array() > spans.array()).any()) continue;
      near[static_cast<std::size_t>(i)] = &blocks_[search(first + step)].places;
    }
    for (int dx = -1; dx <= 1; ++dx) {
      const int x = ((cell.x() + dx) >> 2) - first.x();
      for (int dy = -1; dy <= 1; ++dy) {
        const int y = ((cell.y() + dy) >> 2) - first.y();
        for (int dz = -1; dz <= 1; ++dz) {
          const int z = ((cell.z() + dz) >> 2) - first.z();
          const Places& places = *near[static_cast<std::size_t>(4 * x + 2 * y + z)];
          const std::uint32_t at = places[within(cell.x() + dx, cell.y() + dy, cell.z() + dz)];
          if (at != kNone) visit(at, dx, dy, dz);
        }
      }
    }
  }

  /// Calls `visit(cell, place)` for each cell that has an index.
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (const Block& block : blocks_) {
      for (std::size_t i = 0; i < block.places.size(); ++i) {
        const Eigen::Vector3i within(static_cast<int>(i >> 4), static_cast<int>((i >> 2) & 3), static_cast<int>(i & 3));
        if (block.places[i] != kNone) visit(Eigen::Vector3i(block.block * kSide + within), block.places[i]);
      }
    }
  }

  /// Drops the blocks for which `far(middle)` is true, `middle` being the cell at the block's centre. Calls
  /// `forget(place)` for each index in them.
  template <class Far, class Forget>
  void erase_blocks(Far&& far, Forget&& forget) {
    std::size_t kept = 1;
    for (std::size_t i = 1; i < blocks_.size(); ++i) {
      if (far(Eigen::Vector3i(blocks_[i].block * kSide + Eigen::Vector3i::Constant(kSide / 2)))) {
        for (const std::uint32_t at : blocks_[i].places) {
          if (at != kNone) forget(at);
        }
      } else {
        if (kept != i) blocks_[kept] = blocks_[i];
        ++kept;
      }
    }
    blocks_.resize(kept);
    index_.clear(kept);
    for (std::size_t i = 1; i < kept; ++i) {
      index_.find_or_insert(voxel_key(blocks_[i].block), static_cast<std::uint32_t>(i));
    }
  }

 private:
  struct Block {
    Eigen::Vector3i block;
    Places places;
  };
  static constexpr Places kNothing = [] {
    Places none{};
    none.fill(kNone);
    return none;
  }();

  [[nodiscard]] static Eigen::Vector3i block_of(const Eigen::Vector3i& cell) {
    return {cell.x() >> 2, cell.y() >> 2, cell.z() >> 2};
  }
  [[nodiscard]] static std::size_t within(int x, int y, int z) {
    return static_cast<std::size_t>(((x & 3) << 4) | ((y & 3) << 2) | (z & 3));
  }
  [[nodiscard]] std::size_t search(const Eigen::Vector3i& block) const {
    const std::uint32_t at = index_.find(voxel_key(block));
    return at == kNone ? 0 : at;
  }
  std::vector<Block> blocks_;  // the first is the empty block
  FlatIndex index_;
};

}  // namespace curbstone::mapper::voxels
