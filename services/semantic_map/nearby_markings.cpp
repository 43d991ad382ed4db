#include "services/semantic_map/nearby_markings.hpp"

#include <cmath>
#include <limits>
#include <unordered_map>

#include "services/semantic_map/curb_lines/curb_bridges.hpp"
#include "services/semantic_map/marking_lines/cut_lines.hpp"
#include "services/semantic_map/semantic_messages.hpp"

namespace curbstone::semantic_map {
namespace {

constexpr std::size_t kMaxMarkingVertices = 2200;  // 13 bytes each, 33 a line that has two or more: below 48 kB
constexpr double kSmallerBox = 0.7;                // of the range, where there are more
constexpr double kBeyondBox = 4.0;                 // m, of cells that lines at the box's edge are linked with
constexpr double kBeforeKerb = 0.15;               // m from a curb's foot towards the road
constexpr double kKerbstone = 0.45;                // m from it over the stone
constexpr double kAlongKerb = 0.15;                // m; a line's vertices are 0.2 m apart

/// The stones of curb lines: bright, narrow, and where the kerb is lowered hardly higher than the road, or not at all.
class Kerbstones {
 public:
  explicit Kerbstones(const std::vector<tile::CurbLine>& curbs) {
    add(curbs);
    add(curb_lines::flush_kerbs(curbs));
  }
  [[nodiscard]] bool hold(const Eigen::Vector2d& at) const {
    const TileKey centre = square(at);
    for (std::int32_t x = centre.x - 1; x <= centre.x + 1; ++x) {
      for (std::int32_t y = centre.y - 1; y <= centre.y + 1; ++y) {
        const auto it = vertices_.find({x, y});
        if (it == vertices_.end()) continue;
        for (const tile::CurbVertex& v : it->second)
          if (is_on_stone_of(v, at)) return true;
      }
    }
    return false;
  }

 private:
  void add(const std::vector<tile::CurbLine>& lines) {
    for (const tile::CurbLine& line : lines) {
      for (const tile::CurbVertex& v : line.points) vertices_[square({double{v.x}, double{v.y}})].push_back(v);
    }
  }
  static TileKey square(const Eigen::Vector2d& at) {
    return {static_cast<std::int32_t>(std::floor(at.x() / kSquare)),
            static_cast<std::int32_t>(std::floor(at.y() / kSquare))};
  }
  static bool is_on_stone_of(const tile::CurbVertex& v, const Eigen::Vector2d& at) {
    const Eigen::Vector2d d(at.x() - double{v.x}, at.y() - double{v.y});
    const double across = d.x() * double{v.high_side_x} + d.y() * double{v.high_side_y};
    const double along = d.x() * double{v.high_side_y} - d.y() * double{v.high_side_x};
    return across > -kBeforeKerb && across < kKerbstone && std::abs(along) < kAlongKerb;
  }

  static constexpr double kSquare = 0.5;  // m
  std::unordered_map<TileKey, std::vector<tile::CurbVertex>, TileKeyHash> vertices_;
};

std::vector<marking_lines::MapMarkingCell> cells_in(const Eigen::Vector2d& min, const Eigen::Vector2d& max,
                                                    const TilePipeline& pipeline, const Kerbstones& kerbs) {
  std::vector<marking_lines::MapMarkingCell> cells;
  for (const TileKey& key : pipeline.keys()) {
    const Eigen::Vector2d corner(key.x * kTileSize, key.y * kTileSize);
    if ((corner.array() + kTileSize < min.array()).any() || (corner.array() > max.array()).any()) continue;
    for (const markings::MarkingCell& cell : *pipeline.markings(key)) {
      const Eigen::Vector2d at = corner + Eigen::Vector2d(double{cell.x}, double{cell.y});
      if ((at.array() < min.array()).any() || (at.array() > max.array()).any() || kerbs.hold(at)) continue;
      cells.push_back({at, double{cell.z}, double{cell.contrast}, cell.is_strong});
    }
  }
  return cells;
}

std::size_t message_size(const std::vector<tile::MarkingLine>& lines) {
  std::size_t vertices = 0;
  for (const tile::MarkingLine& line : lines) vertices += line.points.size() + 1;
  return vertices;
}

}  // namespace

std::vector<tile::MarkingLine> all_markings(const TilePipeline& pipeline, const std::vector<tile::CurbLine>& curbs,
                                            const std::vector<Eigen::Vector2d>& path,
                                            const markings::MarkingParameters& parameters) {
  constexpr double kAll = std::numeric_limits<double>::max();
  return marking_lines::link_markings(
      cells_in(Eigen::Vector2d::Constant(-kAll), Eigen::Vector2d::Constant(kAll), pipeline, Kerbstones(curbs)), path,
      parameters);
}

marking_lines_t NearbyMarkings::next(const TilePipeline& pipeline, const std::vector<tile::CurbLine>& curbs,
                                     const Eigen::Vector2d& vehicle, const std::vector<Eigen::Vector2d>& path) {
  const Kerbstones kerbs(curbs);
  double range = range_;
  const auto lines_about = [&] {
    const double reach = range + kBeyondBox;
    const auto linked = marking_lines::link_markings(
        cells_in(vehicle.array() - reach, vehicle.array() + reach, pipeline, kerbs), path, parameters_);
    return marking_lines::cut_lines(linked, vehicle.array() - range, vehicle.array() + range);
  };
  std::vector<tile::MarkingLine> lines = lines_about();
  while (message_size(lines) > kMaxMarkingVertices) {
    range *= kSmallerBox;
    lines = lines_about();
  }
  ids_.assign(lines);
  marking_lines_t message;
  for (int axis = 0; axis < 2; ++axis) {
    message.box_min[axis] = static_cast<float>(vehicle[axis] - range);
    message.box_max[axis] = static_cast<float>(vehicle[axis] + range);
  }
  message.revision = ++revision_;
  message.num_lines = static_cast<std::int32_t>(lines.size());
  for (const tile::MarkingLine& line : lines) message.lines.push_back(to_message(line));
  return message;
}

}  // namespace curbstone::semantic_map
