#include "tools/bench/markings/marking_score.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <unordered_map>

namespace curbstone::bench::markings {
namespace {

using semantic_map::tile::MarkingLine;
using semantic_map::tile::MarkingType;

/// Calls visit(cell) for a band `width` m wide from a to b.
template <class Visit>
void for_band(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double width, Visit visit) {
  constexpr double kStep = 0.04;  // m
  const Eigen::Vector2d d = b - a;
  if (d.norm() < 1e-9) return;
  const Eigen::Vector2d across = Eigen::Vector2d(-d.y(), d.x()).normalized();
  const int along_steps = std::max(1, static_cast<int>(std::ceil(d.norm() / kStep)));
  const int across_steps = static_cast<int>(std::floor(width / 2 / kStep));
  for (int i = 0; i <= along_steps; ++i) {
    for (int k = -across_steps; k <= across_steps; ++k)
      visit(Eigen::Vector2d(a + d * i / along_steps + k * kStep * across));
  }
}

bool any_near(const PaintCells& cells, TileKey at) {
  constexpr int kReach = 2;  // cells: kTolerance
  for (int dx = -kReach; dx <= kReach; ++dx) {
    for (int dy = -kReach; dy <= kReach; ++dy) {
      if (dx * dx + dy * dy <= kReach * kReach && cells.contains({at.x + dx, at.y + dy})) return true;
    }
  }
  return false;
}

double distance_to(const std::vector<Eigen::Vector2d>& line, const Eigen::Vector2d& at) {
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Eigen::Vector2d d = line[i] - line[i - 1];
    const double t = std::clamp((at - line[i - 1]).dot(d) / d.squaredNorm(), 0.0, 1.0);
    best = std::min(best, (line[i - 1] + t * d - at).norm());
  }
  return best;
}

/// The true paint at a place.
struct PaintAt {
  const TrueLine* line = nullptr;
  double beside = std::numeric_limits<double>::infinity();       ///< m from the paint
  double from_centre = std::numeric_limits<double>::infinity();  ///< m
};

PaintAt paint_at(const std::vector<TrueLine>& truth, const Eigen::Vector2d& at) {
  PaintAt best;
  for (const TrueLine& line : truth) {
    const auto consider = [&](const std::vector<Eigen::Vector2d>& centre, double width) {
      if ((centre.front() - at).cwiseAbs().maxCoeff() > 60 && (centre.back() - at).cwiseAbs().maxCoeff() > 60) return;
      const double distance = distance_to(centre, at);
      const double beside = std::max(0.0, distance - width / 2);
      if (std::pair(beside, distance) >= std::pair(best.beside, best.from_centre)) return;
      best = {&line, beside, distance};
    };
    for (const TruePiece& piece : line.pieces) consider(piece.centre, piece.width);
    if (line.middle.size() > 1) consider(line.middle, 0);
  }
  return best;
}

Eigen::Vector2d placed(const semantic_map::tile::MarkingVertex& v, const Pose& T) {
  return (T * Eigen::Vector3f(v.x, v.y, v.z).cast<double>()).head<2>();
}

}  // namespace

TileKey cell_of(const Eigen::Vector2d& at) {
  return {static_cast<std::int32_t>(std::floor(at.x() / kCellSize)),
          static_cast<std::int32_t>(std::floor(at.y() / kCellSize))};
}

void CellScore::add(const CellScore& other) {
  found += other.found;
  found_right += other.found_right;
  painted += other.painted;
  painted_found += other.painted_found;
}

void LineScore::add(const LineScore& other) {
  cells.add(other.cells);
  right_metres += other.right_metres;
  false_metres += other.false_metres;
  typed_metres += other.typed_metres;
  for (std::size_t is = 0; is < types.size(); ++is) {
    for (std::size_t found = 0; found < types.size(); ++found) types[is][found] += other.types[is][found];
  }
  driven += other.driven;
  lateral.insert(lateral.end(), other.lateral.begin(), other.lateral.end());
}

PaintCells cells_of(const std::vector<MarkingLine>& lines, const Pose& T) {
  PaintCells cells;
  for (const MarkingLine& line : lines) {
    for (std::size_t i = 1; i < line.points.size(); ++i) {
      if (!line.points[i - 1].painted) continue;
      for_band(placed(line.points[i - 1], T), placed(line.points[i], T), double{line.width},
               [&](const Eigen::Vector2d& at) { cells.insert(cell_of(at)); });
    }
  }
  return cells;
}

CellScore score_cells(const PaintCells& found, const PaintTruth& truth) {
  CellScore score;
  for (const TileKey& cell : found) {
    if (!any_near(truth.judged, cell)) continue;
    ++score.found;
    if (any_near(truth.painted, cell)) ++score.found_right;
  }
  for (const TileKey& cell : truth.painted) {
    ++score.painted;
    if (any_near(found, cell)) ++score.painted_found;
  }
  return score;
}

LineScore score_lines(const std::vector<MarkingLine>& lines, const Pose& T_truth_map,
                      const std::vector<TrueLine>& truth,
                      const std::function<bool(const Eigen::Vector2d&)>& is_judged) {
  constexpr double kStep = 0.1;  // m
  LineScore score;
  const auto middle_of = [](TileKey cell) {
    return Eigen::Vector2d((cell.x + 0.5) * kCellSize, (cell.y + 0.5) * kCellSize);
  };
  PaintTruth cells;
  for (const TrueLine& line : truth) {
    for (const TruePiece& piece : line.pieces) {
      for (std::size_t i = 1; i < piece.centre.size(); ++i) {
        for_band(piece.centre[i - 1], piece.centre[i], piece.width, [&](const Eigen::Vector2d& at) {
          if (is_judged(at)) cells.painted.insert(cell_of(at));
        });
      }
    }
  }
  const PaintCells found = cells_of(lines, T_truth_map);
  for (const TileKey& cell : found) {
    if (is_judged(middle_of(cell))) cells.judged.insert(cell);
  }
  score.cells = score_cells(found, cells);
  for (const MarkingLine& line : lines) {
    for (std::size_t i = 1; i < line.points.size(); ++i) {
      if (!line.points[i - 1].painted) continue;
      const Eigen::Vector2d a = placed(line.points[i - 1], T_truth_map);
      const Eigen::Vector2d d = placed(line.points[i], T_truth_map) - a;
      const int steps = std::max(1, static_cast<int>(std::lround(d.norm() / kStep)));
      for (int k = 0; k < steps; ++k) {
        const Eigen::Vector2d at = a + d * (k + 0.5) / steps;
        if (!is_judged(at)) continue;
        const double metres = d.norm() / steps;
        const PaintAt paint = paint_at(truth, at);
        if (paint.beside > kTolerance) {
          score.false_metres += metres;
          continue;
        }
        score.right_metres += metres;
        if (paint.line->type == line.type) score.typed_metres += metres;
        score.types[static_cast<std::size_t>(paint.line->type)][static_cast<std::size_t>(line.type)] += metres;
        const bool is_lane = paint.line->type == MarkingType::kSolid || paint.line->type == MarkingType::kDashed;
        if (is_lane) score.lateral.push_back(paint.from_centre);
      }
    }
  }
  return score;
}

}  // namespace curbstone::bench::markings
