#include "services/semantic_map/picture/map_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace curbstone::semantic_map::picture {

namespace {

constexpr Colour kPaper{24, 38, 30};  // unknown, a shade deeper: around the map
constexpr Colour kPath{255, 196, 61};
constexpr Colour kText{236, 240, 236};
constexpr Colour kLine{190, 255, 170};
constexpr Colour kMarking{255, 255, 255};

struct LegendEntry {
  tile::CellClass cell_class;
  const char* name;
};
constexpr std::array<LegendEntry, tile::kNumClasses> kLegend = {{{tile::CellClass::kRoad, "road, pavement"},
                                                                 {tile::CellClass::kCurb, "curb"},
                                                                 {tile::CellClass::kObstacle, "obstacle"},
                                                                 {tile::CellClass::kWall, "wall, vehicle"},
                                                                 {tile::CellClass::kUnknown, "unknown"}}};

/// The cells of all tiles in one grid, cropped to what is known.
struct Grid {
  std::int64_t column0 = 0, row0 = 0;  // of the lower left cell, in cells from the map's origin
  int columns = 0, rows = 0;
  std::vector<tile::CellClass> cell_class;
  std::vector<float> height;  // m; NaN: none

  [[nodiscard]] std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
  }
};

constexpr int kMaxCells = 32000;  // a side, 3.8 km; a pixel each, and the legend, fit on a canvas

Grid lay_out(const MapPicture& map, double margin) {
  std::int64_t low[2] = {std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::int64_t>::max()};
  std::int64_t high[2] = {std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::min()};
  const auto include = [&](std::int64_t column, std::int64_t row) {
    low[0] = std::min(low[0], column);
    high[0] = std::max(high[0], column);
    low[1] = std::min(low[1], row);
    high[1] = std::max(high[1], row);
  };
  const auto for_known = [&](auto visit) {
    for (const tile::MapTile& tile : map.tiles) {
      for (int i = 0; i < tile::kCellsInTile; ++i) {
        if (tile.cell_class[static_cast<std::size_t>(i)] == tile::CellClass::kUnknown) continue;
        visit(tile, static_cast<std::size_t>(i), std::int64_t{tile.key.x} * kCellsPerTile + i % kCellsPerTile,
              std::int64_t{tile.key.y} * kCellsPerTile + i / kCellsPerTile);
      }
    }
  };
  for_known([&](const tile::MapTile&, std::size_t, std::int64_t c, std::int64_t r) { include(c, r); });
  for (const Eigen::Vector2d& p : map.path) {
    if (const auto key = tile_at(p.x(), p.y()))
      include(static_cast<std::int64_t>(p.x() / kCellSize), static_cast<std::int64_t>(p.y() / kCellSize));
  }
  Grid grid;
  if (low[0] > high[0]) include(0, 0);
  const auto edge = static_cast<std::int64_t>(std::ceil(margin / kCellSize));
  grid.column0 = low[0] - edge;
  grid.row0 = low[1] - edge;
  grid.columns = static_cast<int>(std::min<std::int64_t>(kMaxCells, high[0] - low[0] + 1 + 2 * edge));
  grid.rows = static_cast<int>(std::min<std::int64_t>(kMaxCells, high[1] - low[1] + 1 + 2 * edge));
  const std::size_t size = static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows);
  grid.cell_class.assign(size, tile::CellClass::kUnknown);
  grid.height.assign(size, std::numeric_limits<float>::quiet_NaN());
  for_known([&](const tile::MapTile& tile, std::size_t i, std::int64_t c, std::int64_t r) {
    if (c - grid.column0 >= grid.columns || r - grid.row0 >= grid.rows) return;
    const std::size_t k = grid.index(static_cast<int>(c - grid.column0), static_cast<int>(r - grid.row0));
    grid.cell_class[k] = tile.cell_class[i];
    if (tile.height[i] != tile::MapTile::kNoHeight)
      grid.height[k] = tile.z_origin + static_cast<float>(tile.height[i] * kPositionStep);
  });
  return grid;
}

/// Slope of the ground lit from the north-west: -1 (away from the light) .. 1.
double relief(const Grid& grid, int column, int row) {
  const auto height = [&](int c, int r) {
    c = std::clamp(c, 0, grid.columns - 1);
    r = std::clamp(r, 0, grid.rows - 1);
    return grid.height[grid.index(c, r)];
  };
  const float across = height(column - 1, row + 1) - height(column + 1, row - 1);
  if (std::isnan(across)) return 0;
  return std::clamp(-double{across} / 0.12, -1.0, 1.0);
}

void draw_cells(const Grid& grid, int scale, bool shade, Canvas& canvas) {
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const tile::CellClass c = grid.cell_class[grid.index(column, row)];
      if (c == tile::CellClass::kUnknown) continue;
      Colour colour = class_colour(c);
      if (shade && c == tile::CellClass::kRoad) {
        const double light = relief(grid, column, row);
        colour = mix(colour, light > 0 ? Colour{255, 255, 255} : Colour{0, 0, 0}, 0.22 * std::abs(light));
      }
      canvas.fill(column * scale, (grid.rows - 1 - row) * scale, scale, scale, colour);
    }
  }
}

/// From m in map to pixels.
struct ToPixels {
  const Grid& grid;
  int scale;
  [[nodiscard]] Eigen::Vector2d operator()(double x, double y) const {
    return {(x / kCellSize - static_cast<double>(grid.column0)) * scale,
            (static_cast<double>(grid.row0 + grid.rows) - y / kCellSize) * scale};
  }
};

void draw_line(const std::vector<Eigen::Vector2d>& points, const ToPixels& pixel, double thickness, Colour colour,
               double opacity, Canvas& canvas) {
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Eigen::Vector2d a = pixel(points[i - 1].x(), points[i - 1].y());
    const Eigen::Vector2d b = pixel(points[i].x(), points[i].y());
    if ((b - a).norm() < 1e5) canvas.line(a.x(), a.y(), b.x(), b.y(), thickness, colour, opacity);
  }
}

/// Two pieces in three.
void draw_dashes(const std::vector<Eigen::Vector2d>& points, const ToPixels& pixel, double thickness, Colour colour,
                 Canvas& canvas) {
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (i % 3 != 0) draw_line({points[i - 1], points[i]}, pixel, thickness, colour, 0.9, canvas);
  }
}

/// A band with square ends; a broad one in strips, since the canvas draws round ends.
void draw_band(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double thickness, Canvas& canvas) {
  constexpr double kStrip = 2.0;  // pixels
  const double length = (b - a).norm();
  if (!(length > 1e-9 && length < 1e5)) return;
  const Eigen::Vector2d across = Eigen::Vector2d(a.y() - b.y(), b.x() - a.x()) / length;
  const int strips = std::clamp(static_cast<int>(thickness / kStrip), 1, 1000);
  const double width = thickness / strips;
  for (int k = 0; k < strips; ++k) {
    const Eigen::Vector2d off = (k + 0.5 - 0.5 * strips) * width * across;
    canvas.line(a.x() + off.x(), a.y() + off.y(), b.x() + off.x(), b.y() + off.y(), width, kMarking, 0.95);
  }
}

void draw_path(const std::vector<Eigen::Vector2d>& path, const ToPixels& pixel, Canvas& canvas) {
  if (path.empty()) return;
  const double width = std::max(2.0, 0.35 * pixel.scale);
  draw_line(path, pixel, width + 2, {0, 0, 0}, 0.35, canvas);
  draw_line(path, pixel, width, kPath, 1, canvas);
  const Eigen::Vector2d start = pixel(path.front().x(), path.front().y());
  const Eigen::Vector2d end = pixel(path.back().x(), path.back().y());
  canvas.disc(start.x(), start.y(), 1.6 * width, kPath);
  canvas.disc(start.x(), start.y(), 0.9 * width, {40, 40, 40});
  canvas.disc(end.x(), end.y(), 1.6 * width, kPath);
}

/// 1, 2 or 5 times a power of ten, near `length`.
double round_length(double length) {
  const double power = std::pow(10, std::floor(std::log10(length)));
  for (const double step : {5.0, 2.0, 1.0}) {
    if (step * power <= length) return step * power;
  }
  return power;
}

/// A strip below the map: classes, path, scale bar, title.
class Footer {
 public:
  static int height(int scale) { return 5 * Canvas::kTextHeight * scale; }

  Footer(Canvas& canvas, int top, int scale) : canvas_(canvas), top_(top), scale_(scale), x_(8 * scale) {
    canvas_.fill(0, top, canvas.width(), height(scale), kPaper);
    canvas_.fill(0, top, canvas.width(), std::max(1, scale / 2), mix(kPaper, kText, 0.25));
  }
  void swatch(Colour colour, const char* name) {
    const int size = Canvas::kTextHeight * scale_;
    wrap(size + 4 * scale_ + canvas_.text_width(name, scale_));
    canvas_.fill(x_, y_, size, size, mix(colour, kText, 0.5));
    canvas_.fill(x_ + 1, y_ + 1, size - 2, size - 2, colour);
    finish(size, name);
  }
  void stroke(Colour colour, const char* name) {
    const int size = 2 * Canvas::kTextHeight * scale_;
    wrap(size + 4 * scale_ + canvas_.text_width(name, scale_));
    const double middle = y_ + 0.5 * Canvas::kTextHeight * scale_;
    canvas_.line(x_, middle, x_ + size, middle, 2.0 * scale_, colour);
    finish(size, name);
  }
  void scale_bar(double pixels_per_metre) {
    const double metres = round_length(std::max(0.1, 0.2 * canvas_.width() / pixels_per_metre));
    const int length = static_cast<int>(metres * pixels_per_metre);
    const std::string label = metres >= 1 ? fmt::format("{:.0f} m", metres) : fmt::format("{:.1f} m", metres);
    wrap(length + 4 * scale_ + canvas_.text_width(label, scale_));
    const int size = Canvas::kTextHeight * scale_;
    canvas_.fill(x_, y_ + size - 2 * scale_, length, 2 * scale_, kText);
    canvas_.fill(x_, y_, scale_, size, kText);
    canvas_.fill(x_ + length - scale_, y_, scale_, size, kText);
    finish(length, label);
  }
  void words(const std::string& text) {
    wrap(canvas_.text_width(text, scale_));
    canvas_.text(x_, y_, text, scale_, kText);
    x_ += canvas_.text_width(text, scale_) + 10 * scale_;
  }

 private:
  void wrap(int width) {
    if (y_ == 0) y_ = top_ + 8 * scale_;
    if (x_ + width > canvas_.width() - 8 * scale_ && x_ > 8 * scale_) {
      x_ = 8 * scale_;
      y_ += (Canvas::kTextHeight + 6) * scale_;
    }
  }
  void finish(int size, const std::string& name) {
    canvas_.text(x_ + size + 4 * scale_, y_, name, scale_, kText);
    x_ += size + 4 * scale_ + canvas_.text_width(name, scale_) + 10 * scale_;
  }

  Canvas& canvas_;
  int top_;
  int scale_;
  int x_;
  int y_ = 0;
};

}  // namespace

Colour class_colour(tile::CellClass cell_class) {
  switch (cell_class) {
    case tile::CellClass::kRoad:
      return {158, 160, 162};
    case tile::CellClass::kCurb:
      return {60, 220, 70};
    case tile::CellClass::kObstacle:
      return {12, 12, 14};
    case tile::CellClass::kWall:
      return {206, 52, 44};
    case tile::CellClass::kUnknown:
      break;
  }
  return {24, 62, 40};
}

Canvas draw_map(const MapPicture& map, const PictureOptions& options) {
  const Grid grid = lay_out(map, options.margin);
  const int longer = std::max(grid.columns, grid.rows);
  const int scale = std::clamp(options.max_pixels / longer, 1, options.pixels_per_cell);
  const int width = grid.columns * scale;
  const int height = grid.rows * scale;
  const int text = std::clamp(std::min(width, height) / 380, 1, 4);
  Canvas canvas(width, height + (options.legend ? Footer::height(text) : 0), class_colour(tile::CellClass::kUnknown));

  draw_cells(grid, scale, options.shade, canvas);
  const ToPixels pixel{grid, scale};
  for (const tile::MarkingLine& line : map.markings) {
    const double thickness = std::max(1.0, double{line.width} / kCellSize * scale);
    for (std::size_t i = 1; i < line.points.size(); ++i) {
      const tile::MarkingVertex& a = line.points[i - 1];
      const tile::MarkingVertex& b = line.points[i];
      if (a.painted) draw_band(pixel(double{a.x}, double{a.y}), pixel(double{b.x}, double{b.y}), thickness, canvas);
    }
  }
  for (const tile::CurbLine& line : map.curbs) {
    std::vector<Eigen::Vector2d> points;
    for (const tile::CurbVertex& v : line.points) points.emplace_back(double{v.x}, double{v.y});
    const double thickness = std::max(1.0, 0.25 * scale);
    if (line.inferred)
      draw_dashes(points, pixel, thickness, kLine, canvas);
    else
      draw_line(points, pixel, thickness, kLine, line.dropped ? 0.45 : 0.9, canvas);
  }
  for (const PictureLine& line : map.overlays) draw_line(line.points, pixel, line.thickness, line.colour, 0.9, canvas);
  draw_path(map.path, pixel, canvas);

  if (options.legend) {
    Footer footer(canvas, height, text);
    for (const LegendEntry& entry : kLegend) footer.swatch(class_colour(entry.cell_class), entry.name);
    if (!map.markings.empty()) footer.stroke(kMarking, "marking");
    if (!map.path.empty()) footer.stroke(kPath, "driven path");
    if (!map.overlays.empty()) footer.stroke(map.overlays.front().colour, map.overlays_are.c_str());
    footer.scale_bar(scale / kCellSize);
    if (!options.title.empty()) footer.words(options.title);
  }
  return canvas;
}

}  // namespace curbstone::semantic_map::picture
