#pragma once

#include <cstddef>
#include <vector>

namespace curbstone::semantic_map::curb_lines {

/// Numbers of the ends of line pieces: piece k ends at 2 k and begins at 2 k + 1.
[[nodiscard]] constexpr std::size_t last_end(std::size_t piece) {
  return 2 * piece;
}
[[nodiscard]] constexpr std::size_t first_end(std::size_t piece) {
  return 2 * piece + 1;
}
[[nodiscard]] constexpr std::size_t piece_of(std::size_t end) {
  return end / 2;
}
/// The other end of the same piece.
[[nodiscard]] constexpr std::size_t opposite(std::size_t end) {
  return end ^ 1U;
}

/// A candidate joint of two ends.
struct Joint {
  double gap = 0;  ///< m
  std::size_t a = 0, b = 0;
};

inline constexpr std::size_t kFree = ~std::size_t{0};

/// For each end the end that it is joined to, or kFree. The shortest gaps are closed first (of equal ones, that with
/// the lower ends); an end is joined once, and no line closes to a ring.
[[nodiscard]] std::vector<std::size_t> join_shortest_first(std::size_t num_pieces, std::vector<Joint> joints);

}  // namespace curbstone::semantic_map::curb_lines
