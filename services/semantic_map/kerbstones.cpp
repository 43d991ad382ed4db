#include "services/semantic_map/kerbstones.hpp"

#include <cmath>

#include "services/semantic_map/curb_lines/curb_bridges.hpp"

namespace curbstone::semantic_map {
namespace {

constexpr double kBeforeKerb = 0.15;  // m from a curb's foot towards the road
constexpr double kKerbstone = 0.45;   // m from the foot over the stone
constexpr double kAlongKerb = 0.15;   // m; a line's vertices are 0.2 m apart
constexpr double kSquare = 0.5;       // m
constexpr double kStep = 0.2;         // m between tested places of the straight line: as far apart as vertices
constexpr double kCrossed = 0.16;     // m from a tested place to a vertex that is crossed there

TileKey square_of(const Eigen::Vector2d& at) {
  return {static_cast<std::int32_t>(std::floor(at.x() / kSquare)),
          static_cast<std::int32_t>(std::floor(at.y() / kSquare))};
}

bool is_on_stone_of(const tile::CurbVertex& v, const Eigen::Vector2d& at) {
  const Eigen::Vector2d d(at.x() - double{v.x}, at.y() - double{v.y});
  const double across = d.x() * double{v.high_side_x} + d.y() * double{v.high_side_y};
  const double along = d.x() * double{v.high_side_y} - d.y() * double{v.high_side_x};
  return across > -kBeforeKerb && across < kKerbstone && std::abs(along) < kAlongKerb;
}

}  // namespace

Kerbstones::Kerbstones(const std::vector<tile::CurbLine>& curbs) {
  add(curbs, false);
  add(curb_lines::flush_kerbs(curbs), true);
}

void Kerbstones::add(const std::vector<tile::CurbLine>& lines, bool are_flush) {
  for (const tile::CurbLine& line : lines) {
    const bool is_raised = !are_flush && !line.dropped;
    for (const tile::CurbVertex& v : line.points)
      vertices_[square_of({double{v.x}, double{v.y}})].push_back({v, is_raised});
  }
}

/// Calls visit(vertex) for the vertices in the squares around a place, until it returns true.
template <class Visit>
void Kerbstones::for_near(const Eigen::Vector2d& at, Visit visit) const {
  const TileKey centre = square_of(at);
  for (std::int32_t x = centre.x - 1; x <= centre.x + 1; ++x) {
    for (std::int32_t y = centre.y - 1; y <= centre.y + 1; ++y) {
      const auto it = vertices_.find({x, y});
      if (it == vertices_.end()) continue;
      for (const Vertex& v : it->second)
        if (visit(v)) return;
    }
  }
}

bool Kerbstones::contains(const Eigen::Vector2d& at) const {
  bool holds = false;
  for_near(at, [&](const Vertex& v) { return holds = is_on_stone_of(v, at); });
  return holds;
}

bool Kerbstones::separates(const Eigen::Vector2d& road, const Eigen::Vector2d& at, Which which) const {
  const Eigen::Vector2d way = road - at;
  const double length = way.norm();
  for (double walked = 0; walked < length; walked += kStep) {
    const Eigen::Vector2d here = at + way * (walked / length);
    const Vertex* crossed = nullptr;
    for_near(here, [&](const Vertex& v) {
      const bool is_here = (v.is_raised || which == Which::kAll) &&
                           std::hypot(double{v.x} - here.x(), double{v.y} - here.y()) < kCrossed;
      if (is_here) crossed = &v;
      return is_here;
    });
    if (crossed != nullptr) return way.x() * double{crossed->high_side_x} + way.y() * double{crossed->high_side_y} < 0;
  }
  return false;
}

}  // namespace curbstone::semantic_map
