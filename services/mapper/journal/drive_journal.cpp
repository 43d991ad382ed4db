#include "services/mapper/journal/drive_journal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "common/time/has_passed.hpp"
#include "services/mapper/journal/journal_codec.hpp"
#include "services/mapper/journal/journal_file.hpp"

namespace curbstone::mapper::journal {
namespace {

constexpr std::int64_t kRetry = 60'000'000;           // us
constexpr std::int64_t kRetryWithRoom = 2'000'000;    // us, after a full disk
constexpr std::int64_t kKeepAlivePeriod = 1'000'000;  // us: longest interval between two batches
constexpr std::size_t kWorthwhile = 1'000'000;        // bytes

}  // namespace

void DriveJournal::adopt(const RecordedDrive& drive) {
  is_adopted_ = true;
  writer_.adopt();
  adopted_bytes_ = drive.bytes;
  nodes_ = static_cast<int>(drive.nodes.size());
  edges_ = drive.edges.size();
  rings_ = drive.rings;
  if (drive.local_map) local_map_.adopt(*drive.local_map);
  tiles_.clear();
  for (const auto& [key, tile] : drive.tiles)
    tiles_[key] = {tile.num_records, tile.num_runs, tile.num_records * sizeof(TilePoint)};
}

bool DriveJournal::continue_epoch(std::int32_t epoch, std::int64_t until, const dense_map::DenseMap& map,
                                  const pose_graph::Atlas& atlas) {
  if (!is_adopted_ || epoch_ != 0 || map.is_moving()) return false;
  if (atlas.size() < nodes_ || atlas.edges().size() < edges_) return false;
  for (const auto& [key, written] : tiles_) {
    const dense_map::DenseTile* tile = map.tile(key);
    if (tile == nullptr || tile->num_records() < written.records) return false;  // could not be restored
  }
  epoch_ = epoch;
  until_ = until;
  continues_ = true;
  return true;
}

void DriveJournal::start_epoch(std::int32_t epoch, std::vector<RecordedPose> drive) {
  epoch_ = epoch;
  poses_ = std::move(drive);
  thinning_ = {};
  begins_ = true;
  continues_ = false;
  failed_ = 0;
}

bool DriveJournal::needs_restart(std::int64_t now) const {
  if (failed_ != 0) {
    if (writer_.is_full()) return false;
    return has_passed(kRetry, failed_, now) || (has_passed(kRetryWithRoom, failed_, now) && writer_.has_room_again());
  }
  return !begins_ && evicted_bytes_ > std::max(kWorthwhile, writer_.bytes() / 2);
}

void DriveJournal::add(const RecordedPose& pose) {
  if (failed_ != 0) return;
  if (thinning_.keeps(pose.utime, pose.T_map_base.translation())) poses_.push_back(pose);
}

void DriveJournal::wait(std::int64_t now) {
  if (!is_adopted_ || epoch_ != 0 || !has_passed(kKeepAlivePeriod, appended_, now) || writer_.busy()) return;
  appended_ = now;
  writer_.keep_young();
}

void DriveJournal::set_rings(const intensity::RingHistograms& rings) {
  if (rings.scans == rings_.scans) return;
  rings_ = rings;
  new_rings_ = true;
}

void DriveJournal::write(const dense_map::DenseMap& map, const pose_graph::Atlas& atlas,
                         const std::vector<TileKey>& changed, const std::vector<TileKey>& evicted, std::int64_t now) {
  if (epoch_ == 0 || failed_ != 0) return;
  changed_.insert(changed.begin(), changed.end());
  for (const TileKey& key : evicted) {
    changed_.erase(key);
    unreadable_.remove(key);
    const auto written = tiles_.find(key);
    if (written == tiles_.end()) continue;
    evicted_bytes_ += written->second.bytes;
    tiles_.erase(written);
    evicted_.push_back(key);
  }
  if (writer_.busy()) {
    if (writer_.is_stuck()) give_up(now, "the disk has taken nothing for a minute");
    return;
  }
  std::string items;
  if (begins_) {
    if (poses_.empty()) return;
    begin(items, map, atlas);
  }
  if (std::exchange(continues_, false)) {
    writer_.continue_at(adopted_bytes_);
    append_epoch(items, epoch_, until_);
  }
  if (!writer_.fault().empty()) return give_up(now, writer_.fault());
  items += new_items(map, atlas, now);
  if (items.empty() && !has_passed(kKeepAlivePeriod, appended_, now)) return;
  appended_ = now;
  writer_.append(make_batch(items), is_complete(map, atlas));
}

void DriveJournal::begin(std::string& items, const dense_map::DenseMap& map, const pose_graph::Atlas& atlas) {
  begins_ = false;
  fault_.clear();
  const std::vector<TileKey> keys = map.keys();
  changed_ = {keys.begin(), keys.end()};
  unreadable_.clear();
  evicted_.clear();
  tiles_.clear();
  evicted_bytes_ = 0;
  nodes_ = 0;
  edges_ = 0;
  new_rings_ = rings_.scans > 0;
  writer_.begin();
  append_head(items, config_hash_, epoch_, atlas.num_known());
}

/// Nodes first, for tiles and poses refer to them. Poses last: what they depend on is then in the file.
std::string DriveJournal::new_items(const dense_map::DenseMap& map, const pose_graph::Atlas& atlas, std::int64_t now) {
  std::string items;
  if (std::exchange(new_rings_, false)) append_rings(items, rings_);
  for (; nodes_ < atlas.size() && items.size() < kBatchBytes; ++nodes_)
    append_node(items, atlas.node(nodes_), atlas.driven(nodes_));
  for (; nodes_ == atlas.size() && edges_ < atlas.edges().size() && items.size() < kBatchBytes; ++edges_)
    append_edge(items, atlas.edges()[edges_]);
  for (const TileKey& key : std::exchange(evicted_, {})) append_eviction(items, key);
  for (const TileKey& key : unreadable_.take_due(now)) changed_.insert(key);
  while (nodes_ == atlas.size() && !changed_.empty() && items.size() < kBatchBytes) {
    const TileKey key = *changed_.begin();
    changed_.erase(changed_.begin());
    const dense_map::DenseTile* tile = map.tile(key);
    if (tile == nullptr) continue;
    Written& written = tiles_[key];
    if (tile->num_records() <= written.records) continue;
    const auto content = tile->read();
    if (!content) {
      unreadable_.add(key, now);
      continue;
    }
    unreadable_.remove(key);
    const std::size_t before = items.size();
    append_tile(items, key, tile->z_origin(), *content, written.records, written.runs);
    written = {content->records.size(), content->runs.size(), written.bytes + items.size() - before};
  }
  if (!is_complete(map, atlas)) return items;
  for (const RecordedPose& pose : std::exchange(poses_, {})) append_pose(items, pose);
  return items;
}

bool DriveJournal::is_complete(const dense_map::DenseMap& map, const pose_graph::Atlas& atlas) const {
  return !map.is_moving() && nodes_ == atlas.size() && edges_ == atlas.edges().size() && changed_.empty();
}

void DriveJournal::give_up(std::int64_t now, const std::string& why) {
  failed_ = now;
  fault_ = fmt::format("no journal, a mapper that dies begins a new map: {}", why);
  poses_.clear();
  changed_.clear();
  unreadable_.clear();
  evicted_.clear();
}

}  // namespace curbstone::mapper::journal
