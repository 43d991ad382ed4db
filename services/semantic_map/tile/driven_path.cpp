#include "services/semantic_map/tile/driven_path.hpp"

#include <cmath>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <utility>

namespace curbstone::semantic_map::tile {

namespace {

constexpr std::int32_t kMaxRings = 12;  // 36 m; nearly all queries are nearer to the path
constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace

DrivenPath::DrivenPath(const std::vector<Eigen::Vector2d>& places) {
  for (std::size_t i = 0; i < places.size(); ++i) add(static_cast<std::int64_t>(i), places[i]);
}

void DrivenPath::add(std::int64_t utime, const Eigen::Vector2d& place) {
  if (!places_.emplace(utime, place).second) return;
  if (const auto square = tile_at(place.x(), place.y())) squares_[*square].push_back(utime);
}

void DrivenPath::clear() {
  places_.clear();
  squares_.clear();
}

std::vector<Eigen::Vector2d> DrivenPath::places() const {
  std::vector<Eigen::Vector2d> places;
  places.reserve(places_.size());
  for (const auto& [utime, place] : places_) places.push_back(place);
  return places;
}

template <class Visit>
void DrivenPath::for_ring(const TileKey& centre, std::int32_t ring, Visit visit) const {
  for (std::int32_t dy = -ring; dy <= ring; ++dy) {
    const std::int32_t step = std::abs(dy) == ring || ring == 0 ? 1 : 2 * ring;
    for (std::int32_t dx = -ring; dx <= ring; dx += step) {
      const auto square = squares_.find({centre.x + dx, centre.y + dy});
      if (square == squares_.end()) continue;
      for (const std::int64_t utime : square->second) visit(utime, places_.at(utime));
    }
  }
}

std::optional<Eigen::Vector2d> DrivenPath::nearest(const Eigen::Vector2d& at) const {
  std::pair<double, std::int64_t> best{kInfinity, 0};  // squared distance, then utime
  const auto look = [&](std::int64_t utime, const Eigen::Vector2d& place) {
    best = std::min(best, std::pair((place - at).squaredNorm(), utime));
  };
  const auto centre = tile_at(at.x(), at.y());
  for (std::int32_t ring = 0; centre && ring <= kMaxRings; ++ring) {
    const double nearer = (ring - 1) * kTileSize;  // m: places in this ring and beyond are farther than this
    if (ring > 0 && best.first < nearer * nearer) return places_.at(best.second);
    for_ring(*centre, ring, look);
  }
  for (const auto& [utime, place] : places_) look(utime, place);
  return places_.empty() ? std::nullopt : std::optional(places_.at(best.second));
}

std::optional<Eigen::Vector2d> DrivenPath::direction_near(const Eigen::Vector2d& at, double within) const {
  std::pair<double, std::int64_t> best{within, std::numeric_limits<std::int64_t>::min()};  // distance, then utime
  std::optional<Eigen::Vector2d> direction;
  const auto centre = tile_at(at.x(), at.y());
  const auto rings = static_cast<std::int32_t>(std::ceil(within / kTileSize)) + 1;
  for (std::int32_t ring = 0; centre && ring <= rings; ++ring) {
    for_ring(*centre, ring, [&](std::int64_t utime, const Eigen::Vector2d& place) {
      const std::pair here((place - at).norm(), utime);
      if (here >= best) return;
      const auto it = places_.find(utime);
      if (it == places_.begin() || std::prev(it)->second == place) return;
      best = here;
      direction = (place - std::prev(it)->second).normalized();
    });
  }
  return direction;
}

}  // namespace curbstone::semantic_map::tile
