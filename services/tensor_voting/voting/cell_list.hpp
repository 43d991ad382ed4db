#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "services/tensor_voting/kernels/batch_kernel.hpp"
#include "services/tensor_voting/voting/step_cloud.hpp"

namespace curbstone::tensor_voting::voting {

/// Points sorted by cubic cells, x fastest: the cells of an interval of x within one row (y, z) are one run of points.
/// Inside a cell, points are grouped into blocks of neighbours, at most kBlock each. The order depends on the points
/// alone, not on the number of threads.
class CellList {
 public:
  struct Cell {
    std::int32_t x, y, z;  // index, relative to the lowest
    std::uint32_t begin, end;
  };
  struct Block {
    std::uint32_t cell;
    std::uint32_t begin;
    std::uint32_t count;
  };

  /// Assigns the points to cells of edge `edge` steps, at least kMinEdge. Discards the previous content and keeps its
  /// memory.
  void divide(std::span<const WidePoint> points, std::int32_t edge);
  /// Call it after divide() with the same points: sorts them and makes the blocks.
  void fill(std::span<const WidePoint> points, int threads);

  static constexpr std::int32_t kMinEdge = 1 << 19;  ///< so that an index has 21 bits

  [[nodiscard]] const std::vector<Cell>& cells() const { return cells_; }
  [[nodiscard]] const std::vector<Block>& blocks() const { return blocks_; }
  /// The original index of each point in sorted order.
  [[nodiscard]] const std::vector<std::uint32_t>& source() const { return source_; }
  [[nodiscard]] kernels::VoterArrays arrays() const { return {x_.data(), y_.data(), z_.data(), nullptr, nullptr}; }

  /// Whether the average point has more than `most` others in the cells up to `reach` away.
  [[nodiscard]] bool crowded(int reach, double most) const;
  /// Appends the runs of points in the cells up to `reach` cells away from `cell` in each direction.
  void runs_around(const Cell& cell, int reach, std::vector<kernels::VoterRun>& runs) const;

 private:
  /// The cells of one row (y, z): cells_[begin .. end).
  struct Row {
    std::uint64_t key;
    std::uint32_t begin, end;
  };
  struct Item {
    std::array<std::int32_t, 3> at;  // the low bits
    std::uint32_t source;
  };
  struct Lattice;
  void count_in_cells(std::span<const WidePoint> points, const Lattice& lattice);  // for few cells
  void sort_by_cell(std::span<const WidePoint> points, const Lattice& lattice);
  static void make_compact(std::span<Item> cell, std::uint32_t first, std::uint32_t last, std::uint32_t blocks);
  void index_rows();
  void make_blocks(int threads);
  [[nodiscard]] const Row* find_row(std::int32_t y, std::int32_t z) const;

  std::vector<Cell> cells_;
  std::vector<Block> blocks_;
  std::vector<std::uint32_t> source_;
  std::vector<std::int32_t> x_, y_, z_;  // the low bits; kReadAhead elements of room at the end
  std::vector<Row> rows_;                // open addressing by key; end = 0: free

  std::vector<Item> items_;  // used while the list is built
  std::vector<std::uint32_t> cell_of_point_;
  std::vector<std::uint32_t> next_;  // next free place in each of those cells
};

}  // namespace curbstone::tensor_voting::voting
