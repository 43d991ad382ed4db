#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "tools/bench/timing/timed_in_turn.hpp"

namespace curbstone::bench::voting {

/// Useful single-precision operations of one vote (reference: tensor voting, section 9): what its mathematics asks for,
/// however a kernel goes about it. The offset 3; d^2 5; exp(-d^2/sigma^2) as a scale, a range reduction, a polynomial
/// of degree 5 and a shift of the exponent 14; w / d^2 1; its products with dx and dy 2; added up in W, xx, xy, xz, yy,
/// yz 11, as zz follows from the trace. Tests of points out of reach count nothing, and every point receives its votes
/// on its own: a kernel that uses a pair for both ends gains by it.
inline constexpr double kFlopsPerVote = 36;

/// Ours beside PCL's on one street cloud.
struct BatchRow {
  std::size_t points = 0;
  double length = 20;  ///< m of street; 20 makes the peers' cloud
  double sigma = 0.3;  ///< m
  double radius = 0.9;
  int threads = 2;
  timing::TurnTimes ours{};                ///< votes of all points by all points, and decomposition
  std::optional<timing::TurnTimes> pcl{};  ///< tree and normals
  std::int64_t pair_votes = 0;             ///< cast: ordered pairs within reach
  [[nodiscard]] double pair_votes_per_s() const { return static_cast<double>(pair_votes) / ours.wall_ms * 1e3; }
  [[nodiscard]] double flops_per_s() const { return pair_votes_per_s() * kFlopsPerVote; }
};

/// Fills in the measured fields of `row`. Ours keeps its memory from one cloud to the next. `kernel` as in
/// BatchOptions.
void measure_batch(BatchRow& row, bool with_pcl, const std::string& kernel, const timing::TurnOptions& options);

/// Sum of l1 - l2 over the points of a street of 10,000 at sigma 0.3, to be compared with what independent codes gave
/// for another draw of it (kStickSumOfOthers): the draws differ by about a per cent.
[[nodiscard]] double stick_sum();
inline constexpr double kStickSumOfOthers = 22779.8;

}  // namespace curbstone::bench::voting
