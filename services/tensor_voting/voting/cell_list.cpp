#include "services/tensor_voting/voting/cell_list.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/parallel/parallel_for.hpp"

namespace curbstone::tensor_voting::voting {

namespace {

/// The sort key of a cell: ascending keys are ordered by z, then y, then x. Indices have 21 bits.
std::uint64_t key_of(std::int32_t x, std::int32_t y, std::int32_t z) {
  const auto bits = [](std::int32_t v) { return static_cast<std::uint64_t>(v); };
  return bits(z) << 42 | bits(y) << 21 | bits(x);
}
std::uint64_t row_key(std::int32_t y, std::int32_t z) {
  return key_of(0, y, z);
}

}  // namespace

/// The lattice of cells over the bounding box of the points, counted from its lowest corner.
struct CellList::Lattice {
  WidePoint low;
  WidePoint high;
  double cells_per_step;

  struct Index {
    std::int32_t x, y, z;
  };

  Lattice(std::span<const WidePoint> points, std::int32_t edge)
      : low(points[0]), high(low), cells_per_step(1.0 / edge) {
    for (const WidePoint& p : points) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
  }
  [[nodiscard]] std::int32_t index(std::int64_t v, std::int64_t from) const {
    return static_cast<std::int32_t>(static_cast<double>(v - from) * cells_per_step);
  }
  [[nodiscard]] Index cell_of(const WidePoint& p) const {
    return {index(p.x, low.x), index(p.y, low.y), index(p.z, low.z)};
  }
  [[nodiscard]] Index last() const { return cell_of(high); }
  [[nodiscard]] double volume() const { return (last().x + 1.0) * (last().y + 1.0) * (last().z + 1.0); }
};

namespace {

/// Difference of coordinates of which only the low bits are stored: they wrap, but differences within a cell do not.
std::int32_t minus(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) - static_cast<std::uint32_t>(b));
}
std::int32_t plus(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) + static_cast<std::uint32_t>(b));
}

/// The first point of block `i` of `blocks` among `count` points; block sizes differ by at most one.
std::uint32_t block_begin(std::uint32_t i, std::uint32_t blocks, std::uint32_t count) {
  return static_cast<std::uint32_t>(std::uint64_t{count} * i / blocks);
}

}  // namespace

/// Orders the items of blocks first .. last - 1 of a cell so that each block is compact: divides them recursively in
/// halves along the longest side.
void CellList::make_compact(std::span<Item> cell, std::uint32_t first, std::uint32_t last, std::uint32_t blocks) {
  if (last - first <= 1) return;
  const auto count = static_cast<std::uint32_t>(cell.size());
  const auto at = [&](std::uint32_t i) { return cell.begin() + block_begin(i, blocks, count); };
  std::array<std::int32_t, 3> low = at(first)->at;
  std::array<std::int32_t, 3> high = low;
  for (auto item = at(first); item != at(last); ++item) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], item->at[axis]);
      high[axis] = std::max(high[axis], item->at[axis]);
    }
  }
  std::size_t longest = 0;
  for (std::size_t axis = 1; axis < 3; ++axis) {
    if (high[axis] - low[axis] > high[longest] - low[longest]) longest = axis;
  }
  const std::uint32_t middle = first + (last - first) / 2;
  std::nth_element(at(first), at(middle), at(last), [longest](const Item& a, const Item& b) {
    return a.at[longest] != b.at[longest] ? a.at[longest] < b.at[longest] : a.source < b.source;
  });
  make_compact(cell, first, middle, blocks);
  make_compact(cell, middle, last, blocks);
}

void CellList::divide(std::span<const WidePoint> points, std::int32_t edge) {
  cells_.clear();
  cell_of_point_.resize(points.size());
  if (points.empty()) return;
  const Lattice lattice(points, edge);
  if (lattice.volume() <= 4.0 * static_cast<double>(points.size()) + 65536) {
    count_in_cells(points, lattice);
  } else {
    sort_by_cell(points, lattice);
  }
}

void CellList::count_in_cells(std::span<const WidePoint> points, const Lattice& lattice) {
  const Lattice::Index last = lattice.last();
  next_.assign(static_cast<std::size_t>(lattice.volume()), 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Lattice::Index c = lattice.cell_of(points[i]);
    cell_of_point_[i] = static_cast<std::uint32_t>((c.z * (last.y + 1) + c.y) * (last.x + 1) + c.x);
    ++next_[cell_of_point_[i]];
  }
  std::uint32_t begin = 0;
  auto next = next_.begin();
  for (std::int32_t z = 0; z <= last.z; ++z) {
    for (std::int32_t y = 0; y <= last.y; ++y) {
      for (std::int32_t x = 0; x <= last.x; ++x, ++next) {
        if (*next > 0) cells_.push_back({x, y, z, begin, begin + *next});
        begin += std::exchange(*next, begin);
      }
    }
  }
}

void CellList::sort_by_cell(std::span<const WidePoint> points, const Lattice& lattice) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const Lattice::Index c = lattice.cell_of(points[i]);
    keys[i] = {key_of(c.x, c.y, c.z), i};
  }
  std::sort(keys.begin(), keys.end());
  next_.clear();
  for (std::uint32_t at = 0; at < points.size(); ++at) {
    const std::uint32_t i = keys[at].second;
    if (at == 0 || keys[at].first != keys[at - 1].first) {
      const Lattice::Index c = lattice.cell_of(points[i]);
      cells_.push_back({c.x, c.y, c.z, at, at});
      next_.push_back(at);
    }
    ++cells_.back().end;
    cell_of_point_[i] = static_cast<std::uint32_t>(cells_.size() - 1);
  }
}

void CellList::fill(std::span<const WidePoint> points, int threads) {
  blocks_.clear();
  items_.resize(points.size());
  source_.resize(points.size());
  for (auto* v : {&x_, &y_, &z_}) v->resize(points.size() + kernels::kReadAhead);
  for (std::uint32_t i = 0; i < points.size(); ++i) {  // points of the same cell keep their order
    const auto low = [](std::int64_t v) { return static_cast<std::int32_t>(v); };
    items_[next_[cell_of_point_[i]]++] = {{low(points[i].x), low(points[i].y), low(points[i].z)}, i};
  }
  index_rows();
  make_blocks(threads);
}

void CellList::index_rows() {
  std::size_t num_rows = 0;
  const auto starts_row = [this](std::size_t i) {
    return i == 0 || cells_[i].y != cells_[i - 1].y || cells_[i].z != cells_[i - 1].z;
  };
  for (std::size_t i = 0; i < cells_.size(); ++i) num_rows += starts_row(i) ? 1U : 0U;
  std::size_t capacity = 16;
  while (capacity < 2 * num_rows) capacity *= 2;
  rows_.assign(capacity, {});
  for (std::size_t begin = 0, end = 0; begin < cells_.size(); begin = end) {
    for (end = begin + 1; end < cells_.size() && !starts_row(end); ++end) {
    }
    const Row row{row_key(cells_[begin].y, cells_[begin].z), static_cast<std::uint32_t>(begin),
                  static_cast<std::uint32_t>(end)};
    std::size_t slot = (row.key * 0x9e3779b97f4a7c15ULL) >> 32;
    while (rows_[slot & (capacity - 1)].end != 0) ++slot;
    rows_[slot & (capacity - 1)] = row;
  }
}

const CellList::Row* CellList::find_row(std::int32_t y, std::int32_t z) const {
  const std::uint64_t key = row_key(y, z);
  const std::size_t mask = rows_.size() - 1;
  for (std::size_t slot = (key * 0x9e3779b97f4a7c15ULL) >> 32;; ++slot) {
    const Row& row = rows_[slot & mask];
    if (row.end == 0) return nullptr;
    if (row.key == key) return &row;
  }
}

void CellList::make_blocks(int threads) {
  const auto size = [](const Cell& c) { return c.end - c.begin; };
  std::vector<std::uint32_t> first_block(cells_.size() + 1);
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    first_block[i + 1] = first_block[i] + (size(cells_[i]) + kernels::kBlock - 1) / kernels::kBlock;
  }
  blocks_.resize(first_block.back());
  parallel_for(cells_.size(), 64, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Cell& cell = cells_[i];
      const auto items = std::span(items_).subspan(cell.begin, size(cell));
      const std::array<std::int32_t, 3> corner = items[0].at;
      for (Item& item : items) {
        for (std::size_t axis = 0; axis < 3; ++axis) item.at[axis] = minus(item.at[axis], corner[axis]);
      }
      const std::uint32_t blocks = first_block[i + 1] - first_block[i];
      make_compact(items, 0, blocks, blocks);
      for (std::uint32_t k = cell.begin; k < cell.end; ++k) {
        const Item& item = items[k - cell.begin];
        x_[k] = plus(corner[0], item.at[0]);
        y_[k] = plus(corner[1], item.at[1]);
        z_[k] = plus(corner[2], item.at[2]);
        source_[k] = item.source;
      }
      for (std::uint32_t b = 0; b < blocks; ++b) {
        const std::uint32_t first = block_begin(b, blocks, size(cell));
        blocks_[first_block[i] + b] = {static_cast<std::uint32_t>(i), cell.begin + first,
                                       block_begin(b + 1, blocks, size(cell)) - first};
      }
    }
  });
}

bool CellList::crowded(int reach, double most) const {
  std::uint32_t largest = 0;
  for (const Cell& cell : cells_) largest = std::max(largest, cell.end - cell.begin);
  if (largest * std::pow(2.0 * reach + 1, 3) <= most) return false;  // a cheap bound that almost always holds
  double pairs = 0;
  std::vector<kernels::VoterRun> runs;
  for (const Cell& cell : cells_) {
    runs.clear();
    runs_around(cell, reach, runs);
    double near = 0;
    for (const kernels::VoterRun& run : runs) near += run.count;
    pairs += near * (cell.end - cell.begin);
  }
  return pairs > most * static_cast<double>(source_.size());
}

void CellList::runs_around(const Cell& cell, int reach, std::vector<kernels::VoterRun>& runs) const {
  const auto before = [](const Cell& c, std::int32_t x) { return c.x < x; };
  for (std::int32_t z = std::max(0, cell.z - reach); z <= cell.z + reach; ++z) {
    for (std::int32_t y = std::max(0, cell.y - reach); y <= cell.y + reach; ++y) {
      const Row* const row = find_row(y, z);
      if (row == nullptr) continue;
      const auto row_end = cells_.begin() + row->end;
      const auto first = std::lower_bound(cells_.begin() + row->begin, row_end, cell.x - reach, before);
      const auto last = std::find_if(first, row_end, [&](const Cell& c) { return c.x > cell.x + reach; });
      if (first != last) runs.push_back({first->begin, std::prev(last)->end - first->begin});
    }
  }
}

}  // namespace curbstone::tensor_voting::voting
