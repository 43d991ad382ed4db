#include "services/semantic_map/map_keeper.hpp"

#include <algorithm>
#include <utility>

namespace curbstone {

namespace {

constexpr std::int64_t kLongestBreak = 600'000'000;  // us between two poses of one drive, a restart in between
constexpr std::size_t kMaxPoses = 200'000;           // kept while the disk is full: hours

}  // namespace

MapKeeper::MapKeeper(const std::string& path, std::size_t max_pending_tiles) : max_pending_(max_pending_tiles) {
  if (!path.empty()) store_ = std::make_unique<MapStore>(path);
}

void MapKeeper::start(std::int32_t epoch, std::int64_t utime) {
  if (!store_) return;
  const std::int64_t last = store_->last_utime();
  const bool goes_on =
      trajectory_.empty() && last > 0 && store_->epoch() == epoch && utime > last && utime - last < kLongestBreak;
  epoch_ = epoch;
  tiles_.clear();
  trajectory_.clear();
  curbs_.reset();
  clear_ = clear_ || !goes_on;
}

void MapKeeper::put(const MapTile& tile) {
  if (!store_) return;
  const auto it = tiles_.find(tile.key);
  if (it != tiles_.end())
    it->second = tile;
  else if (tiles_.size() < max_pending_)
    tiles_.emplace(tile.key, tile);
  else
    counters_.add("dropped.unstored_tiles");
}

void MapKeeper::put(const TrajectoryPose& pose) {
  if (!store_) return;
  if (trajectory_.size() < kMaxPoses)
    trajectory_.push_back(pose);
  else
    counters_.add("dropped.unstored_poses");
}

void MapKeeper::put(std::vector<CurbLine> curbs) {
  if (store_) curbs_ = std::move(curbs);
}

void MapKeeper::write() {
  if (store_ && (clear_ || !tiles_.empty() || !trajectory_.empty() || curbs_)) write_batch();
}

void MapKeeper::write_batch() {
  MapStore::Batch batch{
      .clear = clear_, .epoch = epoch_, .trajectory = trajectory_, .curbs = curbs_ ? &*curbs_ : nullptr};
  for (const auto& [key, tile] : tiles_) batch.tiles.push_back(tile);
  std::sort(batch.tiles.begin(), batch.tiles.end(), [](const MapTile& a, const MapTile& b) { return a.key < b.key; });
  try {
    store_->write(batch);
    counters_.add("store.transactions");
    counters_.add("store.tiles", static_cast<std::int64_t>(tiles_.size()));
    tiles_.clear();
    trajectory_.clear();
    curbs_.reset();
    clear_ = false;
    fault_.clear();
  } catch (const MapStoreError& error) {
    counters_.add("faults.store");
    fault_ = "the map is kept in memory only: " + std::string(error.what());
  }
}

void MapKeeper::finish(std::vector<CurbLine> curbs) {
  if (!store_) return;
  curbs_ = std::move(curbs);
  write_batch();
  if (!fault_.empty()) return;
  try {
    store_->close_canonical();
  } catch (const MapStoreError& error) {
    counters_.add("faults.store");
    fault_ = error.what();
  }
  store_.reset();
}

}  // namespace curbstone
