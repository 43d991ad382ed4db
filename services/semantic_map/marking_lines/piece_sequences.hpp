#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "services/semantic_map/marking_lines/marking_pieces.hpp"
#include "services/semantic_map/tile/map_types.hpp"

namespace curbstone::semantic_map::marking_lines {

inline constexpr double kMaxDashLength = 6.5;  ///< m

/// Consecutive pieces of one line, each in the line's direction.
using PieceSequence = std::vector<MarkingPiece>;

/// Joins pieces whose ends point at each other across a gap of up to 9 m, the shortest gaps first. Not across
/// `crossings`, where a line ends.
[[nodiscard]] std::vector<PieceSequence> join_pieces(const std::vector<MarkingPiece>& pieces,
                                                     const std::vector<tile::MarkingLine>& crossings);

/// The same pieces from the other end.
[[nodiscard]] PieceSequence reversed(const PieceSequence& sequence);

/// The parts of a piece before and behind `at`, m along it. Each needs samples: see MarkingPiece.
[[nodiscard]] std::pair<MarkingPiece, MarkingPiece> split(const MarkingPiece& piece, double at);

/// One spline through all pieces. Length and gap of its dashes are given if it is dashed.
[[nodiscard]] tile::MarkingLine line_of(const PieceSequence& sequence, tile::MarkingType type);

[[nodiscard]] double median_of(std::vector<double> values);  ///< 0 of none
[[nodiscard]] tile::MarkingVertex vertex(const Eigen::Vector2d& at, double z, bool painted);
/// 0..1, by how bright the paint is and how much of it (m) there is.
[[nodiscard]] float confidence_of(double contrast, float length);

}  // namespace curbstone::semantic_map::marking_lines
