#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "services/semantic_map/marking_lines/piece_sequences.hpp"

namespace curbstone::semantic_map::marking_lines {

inline constexpr double kMaxHoleLength = 0.6;  ///< m: in a line that is worn
/// Longest dash, in lengths of its gaps: between longer pieces the gaps are holes.
inline constexpr double kMaxDashToGap = 2.2;

/// Whether the ground at a place, m in map, was seen; not where a parked car hid it. An empty function: all of it was.
using SeenGround = std::function<bool(const Eigen::Vector2d&)>;

/// The ground between two pieces.
struct Gap {
  enum class Kind {
    kHole,    ///< worn paint, within one stroke
    kHidden,  ///< no dark ground was seen in it: unknown
    kOpen,    ///< dark ground
  };
  double length = 0;  ///< m
  Kind kind = Kind::kOpen;
};

/// The gaps of a sequence: the first is behind its first piece.
[[nodiscard]] std::vector<Gap> gaps_of(const PieceSequence& sequence, const SeenGround& is_seen);

}  // namespace curbstone::semantic_map::marking_lines
