#include "services/semantic_map/store/map_keeper.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "services/semantic_map/store/damaged_file.hpp"

namespace curbstone::semantic_map::store {

namespace {

constexpr std::int64_t kMaxBreak = 600'000'000;    // us between two poses of one drive, a restart in between
constexpr std::int64_t kRestoredFor = 60'000'000;  // us for which it is reported
constexpr std::size_t kMaxPoses = 200'000;         // kept while the disk is full: hours

}  // namespace

MapKeeper::MapKeeper(const std::string& path, std::size_t max_pending_tiles, bool keep_earlier, UnusableFile unusable)
    : path_(path), max_pending_(max_pending_tiles), keep_earlier_(keep_earlier), unusable_(unusable) {
  if (path.empty()) return;
  state_ = State::kIdle;
  try {
    open_store();
  } catch (const WrongMapFile&) {
    throw;
  } catch (const MapStoreError& error) {
    if (unusable == UnusableFile::kThrows) throw;
    note_error(error.what());
  }
}

void MapKeeper::open_store() {
  try {
    store_ = std::make_unique<MapStore>(path_);
  } catch (const DamagedMapFile&) {
    if (unusable_ == UnusableFile::kThrows) throw;
    damaged_ = set_damaged_aside(path_);
    store_ = std::make_unique<MapStore>(path_);
  }
}

void MapKeeper::note_error(const std::string& error) {
  counters_.add("faults.store");
  fault_ = "the map is kept in memory only: " + error;
}

/// Tries the file again if it could not be used. A drive that has begun meanwhile replaces the stored one.
bool MapKeeper::has_store() {
  if (store_) return true;
  try {
    open_store();
  } catch (const MapStoreError& error) {
    note_error(error.what());
    return false;
  }
  fault_.clear();
  if (state_ == State::kRecording) {
    pending_.clear = true;
    if (keep_earlier_ && store_->first_utime() != 0) pending_.keep_in = store_->free_name();
  }
  return true;
}

MapKeeper::~MapKeeper() {
  if (writing_.valid()) writing_.wait();
}

void MapKeeper::start(std::int32_t epoch, std::int64_t utime) {
  if (!keeps()) return;
  await_writing();
  const bool goes_on = continues_stored(epoch, utime);
  const std::string keep_in = goes_on ? "" : make_room(utime);
  previous_lines_ = goes_on ? read_lines() : nullptr;
  epoch_ = epoch;
  state_ = State::kRecording;
  newest_utime_ = utime;
  if (goes_on) earlier_.adopt(store_->superseded());
  const bool clear = pending_.clear || !goes_on;
  pending_ = {};
  pending_.clear = clear;
  pending_.keep_in = keep_in;
}

/// Whether a drive that begins at `utime` is the stored one, after a restart of the service.
bool MapKeeper::continues_stored(std::int32_t epoch, std::int64_t utime) const {
  return store_ && pending_.trajectory.empty() && store_->last_utime() > 0 && store_->epoch() == epoch &&
         utime > store_->last_utime() && utime - store_->last_utime() < kMaxBreak;
}

std::shared_ptr<const StoredLines> MapKeeper::read_lines() const {
  try {
    const MapReader map(path_);
    const std::vector<TileKey> keys = map.tile_keys();
    return std::make_shared<const StoredLines>(StoredLines{{map.curbs(), map.markings()}, {keys.begin(), keys.end()}});
  } catch (const MapStoreError&) {
    return nullptr;  // a damaged file becomes a fault when it is written to
  }
}

/// The file for the stored drive to be moved to; empty if there is none. Pending changes of that drive are written
/// first.
std::string MapKeeper::make_room(std::int64_t utime) {
  if (!keep_earlier_ || !store_) return {};
  if (state_ == State::kRecording) {
    begin_writing();
    await_writing();
  }
  if (!pending_.keep_in.empty()) return pending_.keep_in;  // the disk is full
  if (store_->first_utime() == 0) return {};
  std::string file = store_->free_name();
  if (state_ == State::kRecording)
    earlier_.move_aside(file, store_->first_utime(), utime);
  else
    earlier_.move_aside_of_predecessor(file, store_->first_utime(), store_->superseded());
  return file;
}

void MapKeeper::corrected_from(std::int64_t first_utime) {
  if (earlier_.correct(first_utime)) pending_.superseded = earlier_.superseded();
}

void MapKeeper::put(const tile::MapTile& tile) {
  if (keeps()) add(tile);
}

void MapKeeper::add(const tile::MapTile& tile) {
  const auto it = pending_.tiles.find(tile.key);
  if (it != pending_.tiles.end())
    it->second = tile;
  else if (pending_.tiles.size() < max_pending_)
    pending_.tiles.emplace(tile.key, tile);
  else
    counters_.add("dropped.unstored_tiles");
}

void MapKeeper::put(const tile::TrajectoryPose& pose) {
  if (!keeps()) return;
  newest_utime_ = std::max(newest_utime_, pose.utime);
  if (pending_.trajectory.size() < kMaxPoses)
    pending_.trajectory.push_back(pose);
  else
    counters_.add("dropped.unstored_poses");
}

void MapKeeper::put(LinkLines lines) {
  if (keeps()) pending_.link_lines = std::move(lines);
}

void MapKeeper::write() {
  if (!keeps() || busy() || !has_store()) return;
  const bool has_changed = pending_.clear || !pending_.tiles.empty() || !pending_.trajectory.empty() ||
                           pending_.lines || pending_.link_lines || pending_.superseded;
  if (has_changed) begin_writing();
}

bool MapKeeper::busy() {
  if (!writing_.valid()) return false;
  if (writing_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return true;
  await_writing();
  return false;
}

void MapKeeper::begin_writing() {
  under_way_ = std::exchange(pending_, {});
  writing_ = std::async(std::launch::async, [this]() -> std::string {
    try {
      link_under_way();
      store_->write(batch_under_way());
      return {};
    } catch (const DamagedMapFile& error) {
      is_damaged_ = true;
      return error.what();
    } catch (const MapStoreError& error) {
      return error.what();
    }
  });
}

void MapKeeper::link_under_way() {
  if (!under_way_.link_lines) return;
  const auto begin = std::chrono::steady_clock::now();
  under_way_.lines = std::exchange(under_way_.link_lines, nullptr)();
  const auto took = std::chrono::steady_clock::now() - begin;
  under_way_.linking_took = std::chrono::duration_cast<std::chrono::microseconds>(took).count();
}

MapStore::Batch MapKeeper::batch_under_way() const {
  MapStore::Batch batch{.clear = under_way_.clear,
                        .keep_in = under_way_.keep_in,
                        .epoch = epoch_,
                        .trajectory = under_way_.trajectory,
                        .curbs = under_way_.lines ? &under_way_.lines->curbs : nullptr,
                        .markings = under_way_.lines ? &under_way_.lines->markings : nullptr,
                        .superseded = under_way_.superseded};
  for (const auto& [key, tile] : under_way_.tiles) batch.tiles.push_back(tile);
  std::sort(batch.tiles.begin(), batch.tiles.end(),
            [](const tile::MapTile& a, const tile::MapTile& b) { return a.key < b.key; });
  return batch;
}

void MapKeeper::await_writing() {
  if (!writing_.valid()) return;
  const std::string error = writing_.get();
  if (under_way_.linking_took > 0) linking_took_ = under_way_.linking_took;
  heed_restored();
  if (error.empty()) {
    counters_.add("store.transactions");
    counters_.add("store.tiles", static_cast<std::int64_t>(under_way_.tiles.size()));
    fault_.clear();
  } else {
    note_error(error);
    take_back();
    if (std::exchange(is_damaged_, false)) leave_damaged();
  }
  under_way_ = {};
}

/// Either the file of an earlier drive, which therefore cannot be moved aside: the file itself is, and nothing of this
/// drive is in it. Or the file of this drive, of which another must be made.
void MapKeeper::leave_damaged() {
  if (unusable_ == UnusableFile::kThrows) return;
  const bool is_of_this_drive = !pending_.clear;
  store_.reset();
  lost_ = lost_ || is_of_this_drive;
  if (is_of_this_drive && !earlier_.superseded().empty()) pending_.superseded = earlier_.superseded();
  try {
    std::string aside = set_damaged_aside(path_);
    pending_.keep_in.clear();
    if (!is_of_this_drive) {
      damaged_ = std::move(aside);
      return;
    }
    counters_.add("store.restored");
    restored_ = fmt::format(
        "somebody wrote to the file during the drive, or the disk damaged it: it is {}, and the map is written again",
        aside);
    restored_utime_ = newest_utime_;
  } catch (const MapStoreError& error) {
    note_error(error.what());
  }
}

void MapKeeper::heed_restored() {
  const std::vector<std::string> restored = store_ ? store_->take_restored() : std::vector<std::string>{};
  if (restored.empty()) return;
  counters_.add("store.restored", static_cast<std::int64_t>(restored.size()));
  restored_ = restored.back();
  restored_utime_ = newest_utime_;
}

/// Makes a failed batch pending again, except what has changed meanwhile.
void MapKeeper::take_back() {
  std::swap(pending_, under_way_);
  for (const auto& [key, tile] : under_way_.tiles) add(tile);
  for (const tile::TrajectoryPose& pose : under_way_.trajectory) put(pose);
  if (under_way_.link_lines) pending_.link_lines = std::move(under_way_.link_lines);
  if (under_way_.lines) pending_.lines = std::move(under_way_.lines);
  if (under_way_.superseded) pending_.superseded = std::move(under_way_.superseded);
}

std::string MapKeeper::fault() const {
  if (!fault_.empty()) return fault_;
  if (restored_utime_ != 0 && newest_utime_ - restored_utime_ < kRestoredFor)
    return fmt::format("{}: {}", path_, restored_);
  if (!damaged_.empty())
    return fmt::format(
        "{}: the file was damaged, as by a power cut, and another is begun; what can be read of it: "
        "sqlite3 {} .recover",
        path_, damaged_);
  return earlier_.fault(newest_utime_);
}

void MapKeeper::finish(tile::MapLines lines) {
  if (!keeps()) return;
  await_writing();
  if (!has_store()) return;
  pending_.link_lines = nullptr;
  pending_.lines = std::move(lines);
  if (!earlier_.superseded().empty()) pending_.superseded = "";  // a closed map names none
  begin_writing();
  await_writing();
  if (!fault_.empty()) return;
  try {
    store_->close_canonical();
    earlier_.remove_superseded();
  } catch (const MapStoreError& error) {
    counters_.add("faults.store");
    fault_ = error.what();
  }
  store_.reset();
  state_ = State::kClosed;
}

}  // namespace curbstone::semantic_map::store
