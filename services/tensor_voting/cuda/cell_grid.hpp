#pragma once

#include <cstdint>

#include "services/tensor_voting/cuda/host_device.hpp"

namespace curbstone::tensor_voting::cuda {

/// Maps cells to sort keys, x fastest: the cells of an interval of x within one row (y, z) are one run of sorted
/// points. Rows are a third of the radius wide, so that few pairs out of reach are tested. Cells are only a sixteenth
/// of the radius long in x, because x merely bounds the runs.
struct CellGrid {
  static constexpr int kReach = 3;                                   ///< rows in each direction that a vote may cross
  static constexpr int kRows = (2 * kReach + 1) * (2 * kReach + 1);  ///< rows that contain a votee's voters
  static constexpr int kFine = 16;                                   ///< cells of x in one radius
  static constexpr int kBitsX = 23;
  static constexpr int kBitsY = 20;
  static constexpr int kBitsZ = 20;
  static constexpr std::uint64_t kNoCell = std::uint64_t{1} << 63;  ///< keys from here on belong to no cell

  float radius = 0;          ///< of a vote, in steps
  std::int32_t edge_x = 1;   ///< in steps
  std::int32_t edge_yz = 1;  ///< in steps

  /// Edges are at least `least_x` and `least_yz` steps. Positions within +-2^22 times `least_x` in x and +-2^19 times
  /// `least_yz` in y and z then have a key.
  CURBSTONE_HD static CellGrid for_radius(double radius, std::int32_t least_x, std::int32_t least_yz) {
    constexpr double kMaxCells = 1 << 30;
    const auto edge = [&](int parts, std::int32_t least) {
      return larger(static_cast<std::int32_t>(::ceil(smaller(radius / parts, kMaxCells))), least);
    };
    return {static_cast<float>(radius), edge(kFine, least_x), edge(kReach, least_yz)};
  }

  CURBSTONE_HD static std::int64_t floor_div(std::int64_t a, std::int64_t b) {
    return a >= 0 ? a / b : -((b - 1 - a) / b);
  }
  /// Whether a position (in steps) has a key.
  CURBSTONE_HD bool contains(std::int64_t x, std::int64_t y, std::int64_t z) const {
    const auto inside = [](std::int64_t index, int bits) {
      const std::int64_t half = std::int64_t{1} << (bits - 1);
      return index >= -half && index < half - 1;
    };
    return inside(floor_div(x, edge_x), kBitsX) && inside(floor_div(y, edge_yz), kBitsY) &&
           inside(floor_div(z, edge_yz), kBitsZ);
  }
  CURBSTONE_HD std::uint64_t key(std::int64_t x, std::int64_t y, std::int64_t z) const {
    const auto biased = [](std::int64_t index, int bits) {
      return static_cast<std::uint64_t>(index + (std::int64_t{1} << (bits - 1)));
    };
    return biased(floor_div(z, edge_yz), kBitsZ) << (kBitsX + kBitsY) |
           biased(floor_div(y, edge_yz), kBitsY) << kBitsX | biased(floor_div(x, edge_x), kBitsX);
  }

  /// Keys low <= key < high.
  struct KeyRange {
    std::uint64_t low = 0;
    std::uint64_t high = 0;
  };
  /// Votees first .. last (keys of one row) that are handled together span at most two radii. Returns the highest key
  /// that still belongs to the stretch that begins at `first`.
  CURBSTONE_HD static std::uint64_t end_of_stretch(std::uint64_t first) {
    constexpr std::uint64_t kMaskX = (std::uint64_t{1} << kBitsX) - 1;
    const std::uint64_t x = smaller((first & kMaskX) + 2 * kFine, kMaskX);
    return (first & ~kMaskX) | x;
  }
  /// The keys of the voters in neighbouring row `row` < kRows that may reach votees with keys first .. last, all of one
  /// row.
  CURBSTONE_HD KeyRange voters_in_row(std::uint64_t first, std::uint64_t last, int row) const {
    constexpr std::int64_t kMaskX = (std::int64_t{1} << kBitsX) - 1;
    constexpr std::int64_t kMaskY = (std::int64_t{1} << kBitsY) - 1;
    constexpr std::int64_t kMaskZ = (std::int64_t{1} << kBitsZ) - 1;
    const int dy = row % (2 * kReach + 1) - kReach;
    const int dz = row / (2 * kReach + 1) - kReach;
    const std::int64_t y = (static_cast<std::int64_t>(first >> kBitsX) & kMaskY) + dy;
    const std::int64_t z = static_cast<std::int64_t>(first >> (kBitsX + kBitsY)) + dz;
    const float gap_y = gap(dy);
    const float gap_z = gap(dz);
    const float left = radius * radius - gap_y * gap_y - gap_z * gap_z;
    if (!(left > 0) || y < 0 || y > kMaskY || z < 0 || z > kMaskZ) return {};
    const std::int64_t reach = static_cast<std::int64_t>(::sqrtf(left) / static_cast<float>(edge_x)) + 1;
    const std::int64_t low = larger((static_cast<std::int64_t>(first) & kMaskX) - reach, std::int64_t{0});
    const std::int64_t high = smaller((static_cast<std::int64_t>(last) & kMaskX) + reach, kMaskX);
    const std::uint64_t base = static_cast<std::uint64_t>(z << (kBitsX + kBitsY) | y << kBitsX);
    return {base + static_cast<std::uint64_t>(low), base + static_cast<std::uint64_t>(high) + 1};
  }

 private:
  /// The minimum distance between points whose rows are `rows` apart.
  CURBSTONE_HD float gap(int rows) const {
    const int between = (rows < 0 ? -rows : rows) - 1;
    return between > 0 ? static_cast<float>(between) * static_cast<float>(edge_yz) : 0.0F;
  }
};

}  // namespace curbstone::tensor_voting::cuda
