#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "tools/bench/timing/interleaved_timing.hpp"

namespace curbstone::bench::voting {

/// Useful single-precision operations per vote (reference: tensor voting, section 9): those of the mathematics,
/// independent of the kernel. The offset 3; d^2 5; exp(-d^2/sigma^2) as a scale, a range reduction, a polynomial of
/// degree 5 and a shift of the exponent 14; w / d^2 1; its products with dx and dy 2; the sums in W, xx, xy, xz, yy, yz
/// 11, as zz follows from the trace. Tests of points out of reach do not count, and every point receives its votes
/// independently: a kernel that uses a pair for both of its points gains by it.
inline constexpr double kFlopsPerVote = 36;

/// Our voting and PCL's normals on one street cloud.
struct BatchRow {
  std::size_t points = 0;
  double length = 20;  ///< m of street; 20 gives the cloud of the comparison
  double sigma = 0.3;  ///< m
  double radius = 0.9;
  int threads = 2;
  timing::TurnTimes ours{};                ///< votes among all points, and decomposition
  std::optional<timing::TurnTimes> pcl{};  ///< k-d tree and normals
  std::int64_t pair_votes = 0;             ///< ordered pairs within reach
  [[nodiscard]] double pair_votes_per_s() const { return static_cast<double>(pair_votes) / ours.wall_ms * 1e3; }
  [[nodiscard]] double flops_per_s() const { return pair_votes_per_s() * kFlopsPerVote; }
};

/// Fills in the measured fields of `row`. Our voter keeps its memory from one cloud to the next. `kernel` as in
/// BatchOptions.
void measure_batch(BatchRow& row, bool with_pcl, const std::string& kernel, const timing::TurnOptions& options);

/// Sum of l1 - l2 over the points of a street of 10,000 at sigma 0.3, for comparison with the result of independent
/// codes on another draw of that street (kStickSumOfOthers): draws differ by about one per cent.
[[nodiscard]] double stick_sum();
inline constexpr double kStickSumOfOthers = 22779.8;

}  // namespace curbstone::bench::voting
