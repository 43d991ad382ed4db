#include "services/semantic_map/voted_tile_assembler.hpp"

#include <algorithm>
#include <cmath>

namespace curbstone {

namespace {

constexpr float kMaxHeight = 1e5F;  // m in map

/// Why a page cannot be used; nullptr if it can. (LCM has made the arrays as long as their counts say.)
const char* defect(const voted_points_t& page) {
  if (page.revision < 1) return "refused.revision";
  if (page.total < 1 || page.total > VotedTileAssembler::kMaxPoints) return "refused.size";
  if (page.num_points < 1 || page.first < 0 || page.first > page.total - page.num_points) return "refused.size";
  if (page.num_scales < 1 || page.num_tensors != page.num_scales * page.num_points) return "refused.size";
  if (!(std::abs(page.z_origin) < kMaxHeight)) return "refused.height";
  for (std::int32_t i = 0; i < page.num_points; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (page.x[k] < 0 || page.x[k] >= kStepsPerTile || page.y[k] < 0 || page.y[k] >= kStepsPerTile)
      return "refused.position";
  }
  for (const float mass : page.mass) {
    if (!(mass >= 0 && mass < 1e9F)) return "refused.mass";
  }
  return nullptr;
}

/// The scale that curbs are found at: the one nearest to 0.3 m.
std::size_t coarse_scale(const voted_points_t& page) {
  const auto off = [](float sigma) { return std::isfinite(sigma) ? std::abs(sigma - 0.3F) : 1e9F; };
  const auto best =
      std::min_element(page.sigma.begin(), page.sigma.end(), [&](float a, float b) { return off(a) < off(b); });
  return static_cast<std::size_t>(best - page.sigma.begin());
}

VotedPoint point_of(const voted_points_t& page, std::size_t i, std::size_t scale) {
  const std::size_t t = scale * static_cast<std::size_t>(page.num_points) + i;
  const auto step = static_cast<float>(kPositionStep);
  VotedPoint p;
  p.x = page.x[i] * step;
  p.y = page.y[i] * step;
  p.z = page.z_origin + page.z[i] * step;
  const Eigen::Vector3f normal(page.normal_x[t], page.normal_y[t], page.normal_z[t]);
  const float length = normal.norm();
  p.normal = length > 0 ? Eigen::Vector3f(normal / length) : Eigen::Vector3f::UnitZ();
  if (p.normal.z() < 0) p.normal = -p.normal;
  p.stick = page.stick[t] / 255.0F;
  p.plate = page.plate[t] / 255.0F;
  p.mass = page.mass[t];
  return p;
}

}  // namespace

void VotedTileAssembler::drop_oldest(Counters& counters) {
  const auto oldest = std::min_element(unfinished_.begin(), unfinished_.end(),
                                       [](const auto& a, const auto& b) { return a.second.turn < b.second.turn; });
  unfinished_.erase(oldest);
  counters.add("dropped.unfinished");
}

std::optional<VotedTile> VotedTileAssembler::add(const voted_points_t& page, Counters& counters) {
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
  if (page.revision < u.tile.revision) {
    counters.add("dropped.superseded");
    return std::nullopt;
  }
  const auto total = static_cast<std::size_t>(page.total);
  if (page.revision > u.tile.revision || u.have.size() != total) {
    if (u.missing > 0) counters.add("dropped.superseded");
    u = {.tile = {key, page.utime, page.revision, page.z_origin, std::vector<VotedPoint>(total)},
         .have = std::vector<bool>(total),
         .missing = page.total};
  }
  u.turn = ++turn_;
  const std::size_t scale = coarse_scale(page);
  for (std::size_t i = 0; i < static_cast<std::size_t>(page.num_points); ++i) {
    const std::size_t at = static_cast<std::size_t>(page.first) + i;
    if (u.have[at]) continue;
    u.have[at] = true;
    --u.missing;
    u.tile.points[at] = point_of(page, i, scale);
  }
  if (u.missing > 0) return std::nullopt;
  VotedTile complete = std::move(u.tile);
  unfinished_.erase(it);
  return complete;
}

}  // namespace curbstone
