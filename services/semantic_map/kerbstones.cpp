#include "services/semantic_map/kerbstones.hpp"

#include <cmath>

#include "services/semantic_map/curb_lines/curb_bridges.hpp"

namespace curbstone::semantic_map {
namespace {

constexpr double kBeforeKerb = 0.15;  // m from a curb's foot towards the road
constexpr double kKerbstone = 0.45;   // m from it over the stone
constexpr double kAlongKerb = 0.15;   // m; a line's vertices are 0.2 m apart
constexpr double kSquare = 0.5;       // m

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
  add(curbs);
  add(curb_lines::flush_kerbs(curbs));
}

void Kerbstones::add(const std::vector<tile::CurbLine>& lines) {
  for (const tile::CurbLine& line : lines) {
    for (const tile::CurbVertex& v : line.points) vertices_[square_of({double{v.x}, double{v.y}})].push_back(v);
  }
}

bool Kerbstones::hold(const Eigen::Vector2d& at) const {
  const TileKey centre = square_of(at);
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

}  // namespace curbstone::semantic_map
