#include "services/semantic_map/marking_lines/marking_pieces.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace curbstone::semantic_map::marking_lines {
namespace {

using curb_lines::SmoothingSpline;

constexpr std::size_t kMinPoints = 3;
constexpr double kMinPieceLength = 0.30;  // m
constexpr double kPieceWidth = 0.35;      // m across within which paint belongs to the piece
constexpr double kMinWidth = 0.1;         // m: limits of the width from which its sides are measured
constexpr double kMaxWidth = 0.5;         // m
constexpr double kLineWidth = 0.36;       // m: broader pieces must be brighter, because mended asphalt is broad
constexpr double kBesideFrom = 0.10;      // m from its edge to where its sides begin: no cell there has its paint
constexpr double kBesideTo = 0.46;        // m, to where they end: the next bar of a crossing begins beyond
constexpr double kSeamTo = 0.25;          // m from its edge
constexpr double kTar = 20;      // 0..255: ground darker than its surroundings by this, and than any road, is tar
constexpr double kSeam = 0.08;   // share of tar along an edge from which on it is a seam
constexpr double kMended = 1.3;  // factor of the contrast that a broad piece along a seam must have
constexpr double kSides = kMaxWidth / 2 + kBesideTo;  // m to each side that are examined
constexpr double kCore = 0.08;                        // m to each side of the middle: cells that are all paint
constexpr double kBesideMiddle = 0.12;                // m from the middle to either line of a double line
constexpr double kEndReach = 0.25;                    // m by which paint may continue beyond the last sample
constexpr double kEndInside = 0.30;                   // m before it, from where on the paint is counted
constexpr double kHalfCell = 0.06;                    // m
constexpr double kEndLength = 1.0;                    // m that determine the direction of an end
constexpr double kCellArea = kCellSize * kCellSize;

/// A cell seen along a piece.
struct AlongCell {
  double s = 0;
  double across = 0;
  double contrast = 0;
  double count = 0;
  double level = 0;
  bool is_bright = false;
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

/// The cells around a piece, by the nearest place of the spline among steps of 0.1 m; its ends are extended.
std::vector<AlongCell> cells_along(const MarkingField& field, const SmoothingSpline& spline, double reach) {
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
    field.all_within(at, reach + kEndReach, [&](std::size_t i, const Eigen::Vector2d& d) {
      const double ahead = d.dot(along);
      const double across = along.x() * d.y() - along.y() * d.x();
      if (ahead < -before || ahead >= behind || std::abs(across) > reach) return;
      const MapMarkingCell& cell = field.cells()[i];
      cells.push_back({s + ahead, across, double{cell.contrast}, static_cast<double>(cell.count), double{cell.level},
                       cell.is_bright});
    });
  }
  return cells;
}

/// Whether a cell is darker than any road, and than its surroundings.
bool is_tar(const AlongCell& cell, double level) {
  return cell.contrast + cell.level < std::min(markings::kDarkestRoad, level - kTar);
}

/// The share of tar along one edge of a piece; `sense` as in ground_beside().
double tar_along(const std::vector<AlongCell>& cells, double last, double half_width, double sense, double level) {
  double tar = 0;
  double all = 0;
  for (const AlongCell& cell : cells) {
    const double beside = sense * cell.across - half_width;
    if (cell.s < 0 || cell.s > last || beside < -kHalfCell || beside > kSeamTo) continue;
    tar += is_tar(cell, level) ? 1 : 0;
    all += 1;
  }
  return all > 0 ? tar / all : 0;
}

/// Contrast of the ground beside a piece, `sense` 1 to its left, -1 to its right. It is relative to the piece's own
/// `level`, since within a patch the ground around is the patch. Another line may lie there, so the darkest quarter of
/// the points counts. Nothing if none was seen.
std::optional<double> ground_beside(const std::vector<AlongCell>& cells, double last, double half_width, double sense,
                                    double level) {
  std::vector<std::pair<double, double>> seen;  // contrast and points
  double all = 0;
  for (const AlongCell& cell : cells) {
    const double beside = sense * cell.across - half_width;
    if (cell.s < 0 || cell.s > last || beside < kBesideFrom || beside > kBesideTo) continue;
    if (is_tar(cell, level)) continue;
    seen.emplace_back(cell.contrast + cell.level - level, cell.count);
    all += cell.count;
  }
  std::sort(seen.begin(), seen.end());
  double below = 0;
  for (const auto& [contrast, count] : seen) {
    below += count;
    if (below >= all / 4) return contrast;
  }
  return std::nullopt;
}

/// Width of the bright ground around the middle of a piece, m, to where it is half as bright. Measured by the
/// brightness of the cells, not by their contrast, because within a broad patch the surroundings are the patch.
double full_width(const std::vector<AlongCell>& cells, double last, double contrast, double level) {
  struct Sum {
    double brightness = 0, count = 0;
  };
  constexpr int kMost = static_cast<int>(kSides / kCellSize);
  std::array<Sum, 2 * kMost + 1> across{};
  for (const AlongCell& cell : cells) {
    const auto k = static_cast<int>(std::lround(cell.across / kCellSize));
    if (cell.s < 0 || cell.s > last || std::abs(k) > kMost) continue;
    Sum& sum = across[static_cast<std::size_t>(k + kMost)];
    sum.brightness += (cell.contrast + cell.level - level) * cell.count;
    sum.count += cell.count;
  }
  double width = 0;
  const auto add = [&](int k) {
    const Sum& sum = across[static_cast<std::size_t>(k + kMost)];
    const double share = sum.count > 0 ? sum.brightness / sum.count / contrast : 0;
    if (share >= 0.5) width += kCellSize * std::min(1.0, share);
    return share >= 0.5;
  };
  for (int k = 0; k <= kMost && add(k);) ++k;
  for (int k = -1; k >= -kMost && add(k);) --k;
  return width;
}

double quantile_of(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Brightness and amount of a piece's paint.
struct PaintAmount {
  double contrast = 0;   ///< 0..255, of its core
  double level = 0;      ///< 0..255, of the ground around the core
  double margin = 0;     ///< m at either end that are not counted here
  double per_metre = 0;  ///< contrast times cells, between the margins

  [[nodiscard]] double width() const { return per_metre * kCellArea / contrast; }  ///< m
};

/// Brightness of the cells across a piece at a place, and of the ground around them.
PaintAmount measure_core(const std::vector<AlongCell>& cells, double middle) {
  PaintAmount core;
  std::vector<double> contrasts;
  for (const AlongCell& cell : cells) {
    if (std::abs(cell.across - middle) > kCore) continue;
    core.level += cell.level;
    contrasts.push_back(cell.contrast);
  }
  core.contrast = quantile_of(contrasts, 0.7);
  core.level /= static_cast<double>(std::max<std::size_t>(contrasts.size(), 1));
  return core;
}

PaintAmount measure_paint(const std::vector<AlongCell>& cells, double last) {
  PaintAmount paint = measure_core(cells, 0);
  paint.margin = std::min(kEndInside, last / 4);
  double painted = 0;
  for (const AlongCell& cell : cells) {
    if (cell.s >= paint.margin && cell.s < last - paint.margin) painted += cell.contrast;
  }
  paint.per_metre = painted / (last - 2 * paint.margin);
  if (paint.width() <= kLineWidth) return paint;
  // Two lines side by side have road in their middle.
  const PaintAmount left = measure_core(cells, kBesideMiddle);
  const PaintAmount right = measure_core(cells, -kBesideMiddle);
  const PaintAmount& line = left.contrast < right.contrast ? left : right;
  if (line.contrast <= paint.contrast) return paint;
  paint.contrast = line.contrast;
  paint.level = line.level;
  return paint;
}

/// The end of the paint: the amount found in the margin, at the piece's own amount per metre; finer than a cell.
void find_ends(const std::vector<AlongCell>& cells, const PaintAmount& paint, double last, MarkingPiece& piece) {
  double before = 0;
  double behind = 0;
  for (const AlongCell& cell : cells) {
    if (cell.s < paint.margin) before += cell.contrast;
    if (cell.s >= last - paint.margin) behind += cell.contrast;
  }
  piece.begin = std::clamp(paint.margin - before / paint.per_metre, -kEndReach, kHalfCell);
  piece.end = std::clamp(last - paint.margin + behind / paint.per_metre, last - kHalfCell, last + kEndReach);
}

void place_ends(const SmoothingSpline& spline, double last, MarkingPiece& piece) {
  const auto direction = [&](double from, double to) {
    return (spline.at(to) - spline.at(from)).head<2>().normalized();
  };
  const double inside = std::min(kEndLength, last);
  piece.begin_direction = direction(inside, 0);
  piece.end_direction = direction(last - inside, last);
  piece.begin_at = spline.at(0).head<2>() - piece.begin * piece.begin_direction;  // begin is negative outside
  piece.end_at = spline.at(last).head<2>() + (piece.end - last) * piece.end_direction;
}

}  // namespace

std::optional<MarkingPiece> measure_piece(const MarkingField& field, const MarkingChain& chain) {
  if (chain.size() < kMinPoints) return std::nullopt;
  MarkingPiece piece;
  piece.samples = lay_out(chain);
  const double last = piece.samples.back().s;
  if (last < kMinPieceLength) return std::nullopt;
  const SmoothingSpline spline(piece.samples);
  const std::vector<AlongCell> around = cells_along(field, spline, kSides);
  std::vector<AlongCell> cells;
  for (const AlongCell& cell : around) {
    if (cell.is_bright && std::abs(cell.across) <= kPieceWidth) cells.push_back(cell);
  }
  const PaintAmount paint = measure_paint(cells, last);
  if (paint.contrast <= 0 || paint.per_metre <= 0) return std::nullopt;
  piece.contrast = paint.contrast;
  piece.width = paint.width();
  find_ends(cells, paint, last, piece);
  place_ends(spline, last, piece);
  const double half_width = std::clamp(piece.width, kMinWidth, kMaxWidth) / 2;
  piece.tar = std::max(tar_along(around, last, half_width, 1, paint.level),
                       tar_along(around, last, half_width, -1, paint.level));
  piece.left = ground_beside(around, last, half_width, 1, paint.level);
  piece.right = ground_beside(around, last, half_width, -1, paint.level);
  piece.full_width = full_width(around, last, piece.contrast, paint.level);
  return piece;
}

bool is_paint(const MarkingPiece& piece, const markings::MarkingParameters& parameters) {
  const double broad =
      std::max(std::clamp(piece.width / kLineWidth, 1.0, kMaxWidth / kLineWidth), piece.full_width / kLineWidth);
  const double mended = broad > 1 && piece.tar > kSeam ? kMended : 1;
  if (piece.contrast < mended * broad * parameters.min_contrast) return false;
  const double most = parameters.side_share * piece.contrast;
  const bool is_above_left = piece.left.value_or(0) <= most;
  const bool is_above_right = piece.right.value_or(0) <= most;
  return parameters.two_sided ? is_above_left && is_above_right : is_above_left || is_above_right;
}

}  // namespace curbstone::semantic_map::marking_lines
