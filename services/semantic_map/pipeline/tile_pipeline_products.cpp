#include <algorithm>
#include <limits>
#include <utility>

#include "services/semantic_map/pipeline/tile_pipeline.hpp"

/// @file
/// TilePipeline: access to its products.

namespace curbstone::semantic_map::pipeline {

std::shared_ptr<const tile::MapTile> TilePipeline::classes(TileKey key) const {
  const auto it = tiles_.find(key);
  return it == tiles_.end() ? nullptr : it->second.classes;
}

std::shared_ptr<const std::vector<curbs::CurbPoint>> TilePipeline::curbs(TileKey key) const {
  const auto it = tiles_.find(key);
  return it == tiles_.end() ? nullptr : it->second.curbs;
}

std::shared_ptr<const std::vector<markings::MarkingCell>> TilePipeline::markings(TileKey key) const {
  const auto it = tiles_.find(key);
  return it == tiles_.end() ? nullptr : it->second.markings;
}

void TilePipeline::note_change(TileKey key, Tile& tile) {
  if (!std::exchange(tile.is_in_changed, true)) changed_.push_back(key);
}

std::vector<TileKey> TilePipeline::take_changed() {
  for (const TileKey& key : changed_) tiles_.at(key).is_in_changed = false;
  return std::exchange(changed_, {});
}

std::vector<TileKey> TilePipeline::keys() const {
  std::vector<TileKey> keys;
  keys.reserve(tiles_.size());
  for (const auto& [key, tile] : tiles_) keys.push_back(key);
  std::sort(keys.begin(), keys.end());
  return keys;
}

std::vector<TileKey> TilePipeline::keys_in(const Eigen::Vector2d& min, const Eigen::Vector2d& max) const {
  const Eigen::Array2d first = (min.array() / kTileSize - 1).ceil();
  const Eigen::Array2d last = (max.array() / kTileSize).floor();
  const Eigen::Array2d span = last - first + 1;
  std::vector<TileKey> keys;
  if (!(span.prod() < static_cast<double>(tiles_.size()))) {
    keys = this->keys();
    std::erase_if(keys, [&](TileKey key) {
      return key.x < first.x() || key.x > last.x() || key.y < first.y() || key.y > last.y();
    });
    return keys;
  }
  constexpr double kMin = std::numeric_limits<std::int32_t>::min();
  constexpr double kMax = std::numeric_limits<std::int32_t>::max();
  for (double x = std::max(first.x(), kMin); x <= std::min(last.x(), kMax); ++x) {
    for (double y = std::max(first.y(), kMin); y <= std::min(last.y(), kMax); ++y) {
      const TileKey key{static_cast<std::int32_t>(x), static_cast<std::int32_t>(y)};
      if (tiles_.contains(key)) keys.push_back(key);
    }
  }
  return keys;
}

Backlog TilePipeline::backlog() const {
  Backlog backlog{.turn = turn_};
  for (const auto& step : stale_) backlog.oldest = std::min(backlog.oldest, first_turn(step));
  return backlog;
}

std::size_t TilePipeline::num_stale() const {
  std::size_t count = 0;
  for (const auto& step : stale_) count += step.size();
  return count;
}

}  // namespace curbstone::semantic_map::pipeline
