#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "services/semantic_map/curb_lines/smoothing_spline.hpp"
#include "services/semantic_map/marking_lines/marking_chains.hpp"
#include "services/semantic_map/markings/marking_parameters.hpp"

namespace curbstone::semantic_map::marking_lines {

/// A piece of paint without a gap: a dash, a bar of a crossing, a line from end to end.
struct MarkingPiece {
  std::vector<curb_lines::SmoothingSpline::Sample> samples;  ///< along it, s from 0
  double begin = 0, end = 0;  ///< m, s of the paint's ends: half a cell or so beyond the samples
  Eigen::Vector2d begin_at = Eigen::Vector2d::Zero(), end_at = Eigen::Vector2d::Zero();  ///< m in map
  Eigen::Vector2d begin_direction = Eigen::Vector2d::UnitX();                            ///< unit, out of the piece
  Eigen::Vector2d end_direction = Eigen::Vector2d::UnitX();
  double width = 0;       ///< m
  double contrast = 0;    ///< 0..255, of the paint
  double full_width = 0;  ///< m, of the bright ground around its middle, up to 1.4; for a strip of a patch the patch's

  std::optional<double> left, right;  ///< as `contrast`, of what lies 0.10 to 0.46 m from its edges, if seen
  double tar = 0;                     ///< 0..1, share of tar in the cells along one of its edges: a filled seam

  [[nodiscard]] double length() const { return end - begin; }
  [[nodiscard]] Eigen::Vector2d middle() const { return 0.5 * (begin_at + end_at); }
  [[nodiscard]] Eigen::Vector2d direction() const { return (end_at - begin_at).normalized(); }
};

/// Measures a piece; nothing if the chain is too short. The ends and the width follow from the amount of paint, so they
/// are finer than a cell.
[[nodiscard]] std::optional<MarkingPiece> measure_piece(const MarkingField& field, const MarkingChain& chain);

/// Whether a piece is brighter, along its whole length, than the ground on both sides. The edge of a patch or of a
/// pavement, and a kerbstone, have one dark side only. A broad piece must be brighter than a line, and more so along a
/// seam, where the asphalt was mended. A side that was not seen is not judged.
[[nodiscard]] bool is_paint(const MarkingPiece& piece, const markings::MarkingParameters& parameters);

}  // namespace curbstone::semantic_map::marking_lines
