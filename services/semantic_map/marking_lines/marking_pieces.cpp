#include "services/semantic_map/marking_lines/marking_pieces.hpp"

#include <algorithm>
#include <cmath>

namespace curbstone::semantic_map::marking_lines {
namespace {

using curb_lines::SmoothingSpline;

constexpr std::size_t kFewestPoints = 3;
constexpr double kShortestPiece = 0.30;  // m
constexpr double kPieceWidth = 0.35;     // m: paint of this piece
constexpr double kCore = 0.08;           // m: where it is whole
constexpr double kEndReach = 0.25;       // m beyond the last sample that paint may go on
constexpr double kEndInside = 0.30;      // m before it, from where what is painted is counted
constexpr double kHalfCell = 0.06;       // m
constexpr double kEndLength = 1.0;       // m that say where a piece points
constexpr double kCellArea = kCellSize * kCellSize;

/// A cell of paint seen along a piece.
struct AlongCell {
  double s = 0;
  double across = 0;
  double contrast = 0;
};

std::vector<SmoothingSpline::Sample> lay_out(const MarkingChain& chain) {
  std::vector<SmoothingSpline::Sample> samples;
  double s = 0;
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const RidgePoint& p = chain[i];
    if (i > 0) {
      const Eigen::Vector2d along = (chain[i - 1].tangent + p.tangent).normalized();
      s += std::max(0.0, (p.at - chain[i - 1].at).dot(along));
    }
    samples.push_back({s, {p.at.x(), p.at.y(), p.z, p.contrast}, std::clamp(p.contrast / 60, 0.05, 1.0)});
  }
  return samples;
}

/// The cells about a piece, by the nearest place of the spline among steps of 0.1 m; its ends are prolonged.
std::vector<AlongCell> cells_along(const MarkingField& field, const SmoothingSpline& spline) {
  constexpr double kStep = 0.1;
  std::vector<AlongCell> cells;
  const int steps = std::max(1, static_cast<int>(std::lround((spline.end() - spline.begin()) / kStep)));
  const double step = (spline.end() - spline.begin()) / steps;
  for (int k = 0; k <= steps; ++k) {
    const double s = spline.begin() + k * step;
    const Eigen::Vector2d at = spline.at(s).head<2>();
    Eigen::Vector2d along = spline.derivative(s).head<2>();
    if (along.norm() < 1e-9) continue;
    along.normalize();
    const double before = k == 0 ? kEndReach : step / 2;
    const double behind = k == steps ? kEndReach : step / 2;
    field.within(at, kPieceWidth + kEndReach, [&](std::size_t i, const Eigen::Vector2d& d) {
      const double ahead = d.dot(along);
      const double across = along.x() * d.y() - along.y() * d.x();
      if (ahead < -before || ahead >= behind || std::abs(across) > kPieceWidth) return;
      cells.push_back({s + ahead, across, field.cells()[i].contrast});
    });
  }
  return cells;
}

double quantile_of(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

std::optional<MarkingPiece> measure_piece(const MarkingField& field, const MarkingChain& chain) {
  if (chain.size() < kFewestPoints) return std::nullopt;
  MarkingPiece piece;
  piece.samples = lay_out(chain);
  const double last = piece.samples.back().s;
  if (last < kShortestPiece) return std::nullopt;
  const SmoothingSpline spline(piece.samples);
  const std::vector<AlongCell> cells = cells_along(field, spline);
  std::vector<double> core;
  double painted = 0;  // contrast times cells, well inside
  const double margin = std::min(kEndInside, last / 4);
  for (const AlongCell& cell : cells) {
    if (std::abs(cell.across) <= kCore) core.push_back(cell.contrast);
    if (cell.s >= margin && cell.s < last - margin) painted += cell.contrast;
  }
  piece.contrast = quantile_of(core, 0.7);
  const double per_metre = painted / (last - 2 * margin);
  if (piece.contrast <= 0 || per_metre <= 0) return std::nullopt;
  piece.width = per_metre * kCellArea / piece.contrast;
  double before = 0;
  double behind = 0;
  for (const AlongCell& cell : cells) {
    if (cell.s < margin) before += cell.contrast;
    if (cell.s >= last - margin) behind += cell.contrast;
  }
  piece.begin = std::clamp(margin - before / per_metre, -kEndReach, kHalfCell);
  piece.end = std::clamp(last - margin + behind / per_metre, last - kHalfCell, last + kEndReach);
  const auto direction = [&](double from, double to) {
    return (spline.at(to) - spline.at(from)).head<2>().normalized();
  };
  const double inside = std::min(kEndLength, last);
  piece.begin_direction = direction(inside, 0);
  piece.end_direction = direction(last - inside, last);
  piece.begin_at = spline.at(0).head<2>() - piece.begin * piece.begin_direction;  // begin is negative outside
  piece.end_at = spline.at(last).head<2>() + (piece.end - last) * piece.end_direction;
  double squares = 0;
  for (const auto& sample : piece.samples) squares += (sample.values - spline.at(sample.s)).head<2>().squaredNorm();
  piece.straight = std::sqrt(squares / static_cast<double>(piece.samples.size()));
  return piece;
}

}  // namespace curbstone::semantic_map::marking_lines
