#include "services/semantic_map/tile/voted_tile_assembler.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/tiles/vector_memory.hpp"

namespace curbstone::semantic_map::tile {

namespace {

constexpr float kMaxHeight = 1e5F;  // m in map

/// Why a page is invalid; nullptr if it is valid. (LCM makes the arrays as long as their counts say.)
const char* defect(const voted_points_t& page) {
  if (page.revision < 1 || page.base < 0 || page.base > page.revision) return "refused.revision";
  if (page.num_pages < 1 || page.num_pages > VotedTileAssembler::kMaxPages) return "refused.size";
  if (page.page < 0 || page.page >= page.num_pages) return "refused.size";
  if (page.total < 0 || page.total > VotedTileAssembler::kMaxPoints) return "refused.size";
  if (page.num_points < 0 || page.first < 0 || page.first > page.total - page.num_points) return "refused.size";
  if (page.num_scales < 1 || page.num_voters != page.num_scales * page.num_points) return "refused.size";
  if (!(std::abs(page.z_origin) < kMaxHeight)) return "refused.height";
  for (std::int32_t i = 0; i < page.num_points; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (page.x[k] < 0 || page.x[k] >= kStepsPerTile || page.y[k] < 0 || page.y[k] >= kStepsPerTile)
      return "refused.position";
  }
  for (std::size_t i = 0; i < page.voter.size(); ++i) {
    const std::int32_t own = page.first + static_cast<std::int32_t>(i) % page.num_points;
    if (page.voter[i] < 0 || page.voter[i] > own) return "refused.voter";
  }
  for (std::size_t i = 0; i < page.point.size(); ++i) {
    if (page.point[i] < 0 || page.point[i] >= page.total || page.scale[i] >= page.num_scales) return "refused.voter";
  }
  for (const float mass : page.mass) {
    if (!(mass >= 0 && mass < 1e9F)) return "refused.mass";
  }
  return nullptr;
}

/// Index of the scale used for curbs: the one nearest to 0.3 m.
std::size_t coarse_scale(const voted_points_t& page) {
  const auto off = [](float sigma) { return std::isfinite(sigma) ? std::abs(sigma - 0.3F) : 1e9F; };
  const auto best =
      std::min_element(page.sigma.begin(), page.sigma.end(), [&](float a, float b) { return off(a) < off(b); });
  return static_cast<std::size_t>(best - page.sigma.begin());
}

VotedTensor tensor_of(const voted_points_t& page, std::size_t i) {
  VotedTensor t;
  const Eigen::Vector3f normal(page.normal_x[i], page.normal_y[i], page.normal_z[i]);
  const float length = normal.norm();
  t.normal = length > 0 ? Eigen::Vector3f(normal / length) : Eigen::Vector3f::UnitZ();
  if (t.normal.z() < 0) t.normal = -t.normal;
  t.stick = page.stick[i] / 255.0F;
  t.plate = page.plate[i] / 255.0F;
  t.mass = page.mass[i];
  return t;
}

/// Appends the points that the tile lacks.
void append_points(const voted_points_t& page, std::size_t scale, VotedTile& tile) {
  const auto first = static_cast<std::size_t>(page.first);
  const auto count = static_cast<std::size_t>(page.num_points);
  const auto step = static_cast<float>(kPositionStep);
  tile.points.make_room(count);
  make_room(count, tile.intensity);
  for (std::size_t i = tile.points.size() - std::min(first, tile.points.size()); i < count; ++i) {
    VotedPoint p;
    p.x = page.x[i] * step;
    p.y = page.y[i] * step;
    p.z = page.z_origin + page.z[i] * step;
    const auto voter = static_cast<std::uint32_t>(page.voter[scale * count + i]);
    if (voter < tile.points.size()) {
      tile.points.append(VotedPoints::Place{p.x, p.y, p.z, tile.points.places()[voter].tensor});
    } else {
      tile.points.push_back(p);
    }
    tile.intensity.push_back(page.intensity[i]);
  }
}

/// Whether all pages are of one tile, and their points are contiguous up to its end.
bool adds_up(const VotedStep& step) {
  const voted_points_t& head = step.pages.front();
  std::int32_t next = -1;
  for (const voted_points_t& page : step.pages) {
    if (page.total != head.total || page.z_origin != head.z_origin || page.sigma != head.sigma) return false;
    if (page.num_points == 0) continue;
    if (next >= 0 && page.first != next) return false;
    next = page.first + page.num_points;
  }
  if (step.base == 0 && head.first != 0) return false;
  return next < 0 || next == head.total;
}

}  // namespace

bool continues(const VotedStep& step, const VotedTile* tile) {
  if (step.base == 0) return true;
  const voted_points_t& head = step.pages.front();
  return tile != nullptr && tile->chain == step.chain && tile->revision >= step.base &&
         tile->z_origin == head.z_origin && static_cast<std::int32_t>(tile->points.size()) >= head.first &&
         static_cast<std::int32_t>(tile->points.size()) <= head.total && tile->intensity.size() == tile->points.size();
}

void take_step(const VotedStep& step, VotedTile& tile) {
  const voted_points_t& head = step.pages.front();
  if (step.base == 0) tile = {};
  tile.key = step.key;
  tile.z_origin = head.z_origin;
  const std::size_t scale = coarse_scale(head);
  for (const voted_points_t& page : step.pages) append_points(page, scale, tile);
  for (const voted_points_t& page : step.pages) {
    for (std::size_t i = 0; i < page.point.size(); ++i) {
      const auto voter = static_cast<std::size_t>(page.point[i]);
      if (page.scale[i] != scale || voter >= tile.points.size()) continue;  // a step may bring no points and name some
      tile.points.set_tensor(tile.points.places()[voter].tensor, tensor_of(page, i));
    }
  }
  tile.chain = step.chain;
  tile.revision = step.revision;
  tile.utime = head.utime;
}

void VotedTileAssembler::drop_oldest(Counters& counters) {
  const auto oldest = std::min_element(unfinished_.begin(), unfinished_.end(),
                                       [](const auto& a, const auto& b) { return a.second.turn < b.second.turn; });
  unfinished_.erase(oldest);
  counters.add("dropped.unfinished");
}

std::optional<VotedStep> VotedTileAssembler::add(voted_points_t page, Counters& counters) {
  if (const char* why = defect(page)) {
    counters.add(why);
    return std::nullopt;
  }
  const TileKey key{page.tile_x, page.tile_y};
  auto it = unfinished_.find(key);
  if (it == unfinished_.end()) {
    if (unfinished_.size() >= kMaxUnfinished) drop_oldest(counters);
    it = unfinished_.try_emplace(key).first;
  }
  Unfinished& u = it->second;
  if (page.revision < u.step.revision) {
    counters.add("dropped.superseded");
    return std::nullopt;
  }
  const bool same = page.revision == u.step.revision && page.chain == u.step.chain && page.base == u.step.base &&
                    page.num_pages == u.num_pages;
  if (!same) {
    if (!u.pages.empty()) counters.add("dropped.superseded");
    u = {.step = {key, page.chain, page.base, page.revision, {}}, .pages = {}, .num_pages = page.num_pages};
  }
  u.turn = ++turn_;
  u.pages.try_emplace(page.page, std::move(page));
  if (u.pages.size() < static_cast<std::size_t>(u.num_pages)) return std::nullopt;
  VotedStep complete = std::move(u.step);
  for (auto& [number, part] : u.pages) complete.pages.push_back(std::move(part));
  unfinished_.erase(it);
  if (adds_up(complete)) return complete;
  counters.add("refused.size");
  return std::nullopt;
}

}  // namespace curbstone::semantic_map::tile
