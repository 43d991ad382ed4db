#include <algorithm>
#include <thread>
#include <utility>

#include "common/parallel/parallel_for.hpp"
#include "services/semantic_map/pipeline/tile_pipeline.hpp"

/// @file
/// TilePipeline: computes everything that is stale, in several threads.

namespace curbstone::semantic_map::pipeline {
namespace {

constexpr std::size_t kSettledAtOnce = 256;  // tiles computed before their products are stored
constexpr unsigned kMaxThreads = 8;

}  // namespace

/// In the order of the steps, because a step makes only later steps stale.
WorkResult TilePipeline::settle(int threads) {
  if (threads <= 0) threads = static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1U, kMaxThreads));
  result_ = {};
  for (const Step step : kUrgentSteps) settle_step(step, threads);
  for (const Step step : kPatientSteps) settle_step(step, threads);
  return std::exchange(result_, {});
}

/// No step reads the result of the same step of another tile, so many tiles are computed in parallel. Their results are
/// stored one after the other.
void TilePipeline::settle_step(Step step, int threads) {
  std::vector<Product> products;  // each is large
  std::vector<std::pair<TileKey, Tile*>> tiles;
  while (!stale_[step].empty()) {
    tiles.clear();
    for (auto it = stale_[step].begin(); it != stale_[step].end() && tiles.size() < kSettledAtOnce; ++it)
      tiles.emplace_back(it->second, find(it->second));
    awakened_.clear();
    for (const auto& [key, tile] : tiles) wake_for(step, key, *tile);
    products.resize(std::max(products.size(), tiles.size()));
    parallel_for(tiles.size(), 1, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) products[i] = compute(step, tiles[i].first, *tiles[i].second);
    });
    num_evidence_ += step == kEvidence ? static_cast<std::int64_t>(tiles.size()) : 0;
    for (std::size_t i = 0; i < tiles.size(); ++i) {
      const auto& [key, tile] = tiles[i];
      unmark(step, *tile);
      std::visit([&, k = key, t = tile](auto& product) { take(k, *t, std::move(product)); }, products[i]);
    }
    for (const TileKey key : awakened_) sleep(key);
  }
}

}  // namespace curbstone::semantic_map::pipeline
