#include "services/semantic_map/markings/marking_cells.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

namespace curbstone::semantic_map::markings {
namespace {

constexpr int kMargin = 10;  // cells, 1.2 m
constexpr int kPatchSide = kCellsPerTile + 2 * kMargin;
constexpr int kBlock = 5;  // cells a side that share their surroundings
constexpr int kReach = 8;  // cells around a block: its cells are 1.0 to 1.5 m from the window's edge
constexpr int kMinCells = 30;
constexpr double kBrightestRoad = 96;  // half as bright again, and no paint between: grass
constexpr double kMaxSpread = 12;      // from cell to cell: more is tar among the asphalt
constexpr int kDirections = 8;
constexpr double kWeakShare = 0.35;  // of the least contrast: where paint's edges are
constexpr double kFromCurb = 0.25;   // m
constexpr double kPavement = 6.0;    // m beyond a curb that are no road
constexpr double kMinSpread = 4;     // of a point's intensity: no sensor is better
constexpr double kSideShare = 0.6;   // of a cell's contrast, that its sides lie below: cell by cell that is noisy
constexpr int kBeside = 5;           // cells about what is bright that are kept

/// What a cell's brightness is, where that is known.
struct Brightness {
  float mean = 0;
  float count = 0;  // points; 0: not known
};

class Patch {
 public:
  explicit Patch(const tile::Around<PaintLayer>& paint) {
    for (int row = 0; row < kPatchSide; ++row) {
      for (int column = 0; column < kPatchSide; ++column) {
        const PaintCell* cell = find(paint, column - kMargin, row - kMargin);
        if (cell == nullptr || cell->count == 0) continue;
        const auto n = static_cast<float>(cell->count);
        at(column - kMargin, row - kMargin) = {static_cast<float>(cell->sum) / n, n};
      }
    }
  }
  /// Indexed from the centre tile's lowest cell.
  [[nodiscard]] const Brightness& at(int column, int row) const {
    return cells_[static_cast<std::size_t>((row + kMargin) * kPatchSide + column + kMargin)];
  }

 private:
  Brightness& at(int column, int row) {
    return cells_[static_cast<std::size_t>((row + kMargin) * kPatchSide + column + kMargin)];
  }
  static const PaintCell* find(const tile::Around<PaintLayer>& paint, int column, int row) {
    const auto tile_of = [](int i) { return i < 0 ? -1 : i >= kCellsPerTile ? 1 : 0; };
    const int dx = tile_of(column);
    const int dy = tile_of(row);
    const PaintLayer* layer = paint.at(dx, dy);
    if (layer == nullptr || layer->cells.empty()) return nullptr;
    const int c = column - dx * kCellsPerTile;
    const int r = row - dy * kCellsPerTile;
    return &layer->cells[static_cast<std::size_t>(r * kCellsPerTile + c)];
  }
  std::array<Brightness, static_cast<std::size_t>(kPatchSide* kPatchSide)> cells_{};
};

/// Level of the ground around a block of cells, from the lower half of its cells: paint is brighter, and half of a
/// crossing is paint. The very end of the distribution is not used: tar is darker. For a normal distribution the 45 %
/// quantile lies 0.126 and the 25 % quantile 0.674 sigma below the middle. A middle brighter than any road is of
/// pavement, or a mixture of road and pavement; with it, slightly brighter slabs would look like paint. There the
/// darker part is taken as the road.
std::optional<double> level_around(const Patch& patch, int column0, int row0) {
  std::array<int, 256> histogram{};
  int known = 0;
  for (int row = row0 - kReach; row < row0 + kBlock + kReach; ++row) {
    for (int column = column0 - kReach; column < column0 + kBlock + kReach; ++column) {
      const Brightness& b = patch.at(column, row);
      if (b.count == 0) continue;
      ++histogram[static_cast<std::size_t>(b.mean)];
      ++known;
    }
  }
  if (known < kMinCells) return std::nullopt;
  const auto quantile = [&](double share) {
    const double wanted = share * known;
    double below = 0;
    for (std::size_t i = 0; i < histogram.size(); ++i) {
      const double n = histogram[i];
      if (below + n >= wanted) return static_cast<double>(i) + (n > 0 ? (wanted - below) / n : 0);
      below += n;
    }
    return 255.0;
  };
  const double middle = quantile(0.45);
  const double low = quantile(0.25);
  if (low > kBrightestRoad) return std::nullopt;
  // Tar around does not turn asphalt into paint.
  if (middle > kBrightestRoad) return std::max(kDarkestRoad, low);
  const double spread = std::min(kMaxSpread, (middle - low) / (0.674 - 0.126));
  return std::max(kDarkestRoad, middle + 0.126 * spread);
}

/// Cells of the two sides in each direction across: 0.36 and 0.48 m away, and one cell to either hand.
struct Side {
  std::array<std::array<int, 2>, 6> cells{};
};
std::array<Side, kDirections> make_sides() {
  std::array<Side, kDirections> sides;
  for (int k = 0; k < kDirections; ++k) {
    const double angle = k * std::numbers::pi / kDirections;
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    std::size_t n = 0;
    for (const double across : {3.0, 4.0}) {
      for (const double along : {-1.0, 0.0, 1.0}) {
        sides[static_cast<std::size_t>(k)].cells[n++] = {static_cast<int>(std::lround(across * c - along * s)),
                                                         static_cast<int>(std::lround(across * s + along * c))};
      }
    }
  }
  return sides;
}
const std::array<Side, kDirections> kSides = make_sides();

/// Mean brightness of a side; `sense` 1 or -1.
std::optional<double> side_level(const Patch& patch, const Side& side, int column, int row, int sense) {
  double sum = 0;
  double n = 0;
  for (const auto& [dx, dy] : side.cells) {
    const Brightness& b = patch.at(column + sense * dx, row + sense * dy);
    sum += double{b.mean} * double{b.count};
    n += double{b.count};
  }
  if (n == 0) return std::nullopt;
  return sum / n;
}

bool stands_out(const Patch& patch, int column, int row, double below, bool two_sided) {
  for (const Side& side : kSides) {
    const auto a = side_level(patch, side, column, row, 1);
    const auto b = side_level(patch, side, column, row, -1);
    const bool is_above_a = a && *a <= below;
    const bool is_above_b = b && *b <= below;
    if (two_sided ? is_above_a && is_above_b : is_above_a || is_above_b) return true;
  }
  return false;
}

/// Whether a place is beside a curb or beyond it: the nearest curb straight across has its higher side there.
bool is_off_road(const tile::Around<std::vector<curbs::CurbPoint>>& curbs, double x, double y) {
  double nearest = kPavement;
  bool is_off = false;
  curbs.for_each([&](const std::vector<curbs::CurbPoint>& points, double dx, double dy) {
    for (const curbs::CurbPoint& p : points) {
      const Eigen::Vector2d d(x - p.foot.x() - dx, y - p.foot.y() - dy);
      const double across = d.dot(p.up);
      const double along = d.x() * p.up.y() - d.y() * p.up.x();
      if (std::abs(along) > kFromCurb || std::abs(across) >= nearest) continue;
      nearest = std::abs(across);
      is_off = across > -kFromCurb;
    }
  });
  return is_off;
}

/// A point's scatter about its cell's mean, of all cells.
double point_variance(const PaintLayer& layer) {
  double squares = 0;
  double n = 0;
  for (const PaintCell& cell : layer.cells) {
    if (cell.count < 2) continue;
    squares += static_cast<double>(cell.squares) -
               static_cast<double>(cell.sum) * static_cast<double>(cell.sum) / static_cast<double>(cell.count);
    n += static_cast<double>(cell.count) - 1;
  }
  return std::max(kMinSpread * kMinSpread, n > 0 ? squares / n : 0);
}

/// Centroid of the brighter part of a cell: points are weighted by their brightness over the ground around. For a cell
/// that is not bright, the centroid of its points.
MarkingCell place(const PaintCell& cell, int column, int row, double level, double contrast, bool is_bright) {
  const auto points = static_cast<double>(cell.count);
  const auto centroid = [&](std::uint32_t by, std::uint32_t sum) {
    const double at = is_bright ? (static_cast<double>(by) - level * static_cast<double>(sum)) /
                                      (static_cast<double>(cell.sum) - level * points)
                                : static_cast<double>(sum) / points;
    return std::clamp(at * kPositionStep, 0.0, kCellSize);
  };
  MarkingCell mark;
  mark.column = static_cast<std::uint8_t>(column);
  mark.row = static_cast<std::uint8_t>(row);
  mark.is_bright = is_bright;
  mark.count = static_cast<std::uint8_t>(std::min(cell.count, 255U));
  mark.x = static_cast<float>(column * kCellSize + centroid(cell.by_x, cell.x));
  mark.y = static_cast<float>(row * kCellSize + centroid(cell.by_y, cell.y));
  mark.z = cell.z;
  mark.contrast = static_cast<float>(contrast);
  mark.level = static_cast<float>(level);
  return mark;
}

/// Level of the ground around each cell, block by block; also beyond the tile's edge.
class Levels {
 public:
  Levels(const Patch& patch, const MarkingParameters& parameters) {
    for (int i = 0; i < kBlocks * kBlocks; ++i) {
      auto& level = levels_[static_cast<std::size_t>(i)];
      level = level_around(patch, i % kBlocks * kBlock, i / kBlocks * kBlock);
      if (level && !parameters.local) level = parameters.level;
    }
  }
  [[nodiscard]] const std::optional<double>& at(int column, int row) const {
    const auto block = [](int i) { return std::clamp(i, 0, kCellsPerTile - 1) / kBlock; };
    return levels_[static_cast<std::size_t>(block(row) * kBlocks + block(column))];
  }

 private:
  static constexpr int kBlocks = kCellsPerTile / kBlock;
  std::array<std::optional<double>, static_cast<std::size_t>(kBlocks* kBlocks)> levels_;
};

/// Cells that may be paint by their brightness alone, and cells near them, also beyond the tile.
class NearBright {
 public:
  NearBright(const Patch& patch, const Levels& levels, double scatter, const MarkingParameters& parameters) {
    for (int row = -kBeside; row < kCellsPerTile + kBeside; ++row) {
      for (int column = -kBeside; column < kCellsPerTile + kBeside; ++column) {
        const Brightness& b = patch.at(column, row);
        const auto& level = levels.at(column, row);
        if (b.count == 0 || !level) continue;
        const double contrast = double{b.mean} - *level;
        if (contrast < parameters.min_contrast) continue;
        if (contrast < parameters.min_sigmas * std::sqrt(scatter / double{b.count})) continue;
        if (!stands_out(patch, column, row, *level + kSideShare * contrast, parameters.two_sided)) continue;
        note(column, row);
      }
    }
  }
  [[nodiscard]] bool holds(int column, int row) const { return bright_[index(column, row)]; }
  [[nodiscard]] bool is_near(int column, int row) const { return near_[index(column, row)]; }

 private:
  static std::size_t index(int column, int row) { return static_cast<std::size_t>(row * kCellsPerTile + column); }
  void note(int column, int row) {
    const auto within = [](int i) { return std::clamp(i, 0, kCellsPerTile - 1); };
    if (within(column) == column && within(row) == row) bright_[index(column, row)] = true;
    for (int r = within(row - kBeside); r <= within(row + kBeside); ++r) {
      for (int c = within(column - kBeside); c <= within(column + kBeside); ++c) near_[index(c, r)] = true;
    }
  }
  std::array<bool, tile::kCellsInTile> bright_{}, near_{};
};

}  // namespace

std::vector<MarkingCell> find_marking_cells(const MarkingSurroundings& around, const MarkingParameters& parameters) {
  std::vector<MarkingCell> marks;
  const PaintLayer* layer = around.paint.centre();
  if (layer == nullptr || layer->cells.empty() || around.classes == nullptr) return marks;
  const Patch patch(around.paint);
  const Levels levels(patch, parameters);
  const double scatter = point_variance(*layer);
  const NearBright bright(patch, levels, scatter, parameters);
  for (int row = 0; row < kCellsPerTile; ++row) {
    for (int column = 0; column < kCellsPerTile; ++column) {
      const auto k = static_cast<std::size_t>(row * kCellsPerTile + column);
      const PaintCell& cell = layer->cells[k];
      const auto& level = levels.at(column, row);
      if (cell.count == 0 || !level || !bright.is_near(column, row)) continue;
      const double contrast = static_cast<double>(cell.sum) / static_cast<double>(cell.count) - *level;
      const bool is_road = around.classes->cell_class[k] == tile::CellClass::kRoad;
      const bool is_bright = is_road && contrast >= kWeakShare * parameters.min_contrast;
      MarkingCell mark = place(cell, column, row, *level, contrast, is_bright);
      mark.is_strong =
          is_bright && bright.holds(column, row) && !is_off_road(around.curbs, double{mark.x}, double{mark.y});
      marks.push_back(mark);
    }
  }
  return marks;
}

}  // namespace curbstone::semantic_map::markings
