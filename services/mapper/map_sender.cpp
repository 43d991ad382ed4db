#include "services/mapper/map_sender.hpp"

#include <algorithm>
#include <curbstone/map_points_t.hpp>
#include <utility>

namespace curbstone::mapper {
namespace {

constexpr std::int32_t kPointsPerMessage = 3000;  // 7 bytes each: 21 kB, well under 48 kB
constexpr std::int64_t kPeriod = 20'000;          // us; a call, as after each scan, covers one period at least
constexpr std::int64_t kMaxPeriods = 13;          // per call at most: a replay calls each 0.25 s
constexpr int kMessagesPerPeriod = 150;
constexpr int kPointsPerPeriod = 5000;         // 35 kB: 1.7 MB/s; mapping at 3 m/s needs 0.25 MB/s
constexpr std::size_t kRequestsPerPeriod = 1;  // tiles, of about 8000 points at most

std::deque<map_trajectory_t> make_trajectory_pages(const std::vector<TrajectoryPoint>& points, std::int32_t epoch) {
  std::deque<map_trajectory_t> pages;
  for (std::size_t first = 0; first < points.size(); first += kMaxPosesPerPage) {
    map_trajectory_t page{};
    const std::size_t end = std::min(first + kMaxPosesPerPage, points.size());
    page.epoch = epoch;
    page.page = static_cast<std::int32_t>(pages.size());
    for (std::size_t i = first; i < end; ++i)
      append_pose(page, points[i].utime, points[i].revolution, points[i].T_map_base.translation().cast<float>(),
                  Eigen::Quaterniond(points[i].T_map_base.linear()).cast<float>());
    pages.push_back(std::move(page));
  }
  for (map_trajectory_t& page : pages) page.num_pages = static_cast<std::int32_t>(pages.size());
  return pages;
}

std::int32_t size_of(const dense_map::TileRecords& content) {
  return static_cast<std::int32_t>(content.records.size());
}

}  // namespace

void MapSender::start_epoch(std::int32_t epoch, const Eigen::Vector3d& position,
                            const std::vector<TrajectoryPoint>& drive) {
  epoch_ = epoch;
  catalog_.start_epoch(epoch);
  sent_.clear();
  changed_.clear();
  unreadable_.clear();
  changed_.set_position(position.x(), position.y());
  trajectory_ = make_trajectory_pages(drive, epoch);
  drive_.start_epoch(epoch, drive);
}

void MapSender::queue_tiles(std::vector<TileKey> tiles) {
  std::stable_sort(tiles.begin(), tiles.end(),
                   [this](TileKey a, TileKey b) { return changed_.distance(a) < changed_.distance(b); });
  for (const TileKey& key : tiles) {
    changed_.push(key);
    catalog_.promise(key);
  }
}

void MapSender::forget(const std::vector<TileKey>& tiles) {
  for (const TileKey& key : tiles) {
    catalog_.remove(key);
    sent_.erase(key);
    unreadable_.remove(key);
  }
}

std::int32_t MapSender::send_records(TileKey key, const dense_map::DenseTile& tile,
                                     const dense_map::TileRecords& content, std::int32_t first, std::int32_t last) {
  last = std::min(last, first + kPointsPerMessage);
  if (last <= first) return first;
  map_points_t message;
  message.utime = tile.utime();
  message.epoch = epoch_;
  message.tile_x = key.x;
  message.tile_y = key.y;
  message.z_origin = static_cast<float>(tile.z_origin());
  message.first = first;
  message.num_points = last - first;
  for (std::int32_t i = first; i < last; ++i) {
    const TilePoint& point = content.records[static_cast<std::size_t>(i)];
    message.x.push_back(point.x);
    message.y.push_back(point.y);
    message.z.push_back(point.z);
    message.intensity.push_back(point.intensity);
  }
  bus_.publish("MAP_POINTS", message);
  return last;
}

void MapSender::send_changes(const dense_map::DenseMap& map, std::int64_t now) {
  periods_ = static_cast<int>(std::clamp<std::int64_t>((now - sent_at_) / kPeriod, 1, kMaxPeriods));
  sent_at_ = now;
  int messages = kMessagesPerPeriod * periods_;
  int points = kPointsPerPeriod * periods_;
  queue_tiles(unreadable_.take_due(now));
  std::vector<TileKey> unfinished;  // a large tile near the vehicle is sent in parts, with other tiles in between
  while (messages > 0 && points > 0) {
    const std::optional<TileKey> key = changed_.pop();
    if (!key) break;
    const dense_map::DenseTile* tile = map.tile(*key);
    if (tile == nullptr) {  // evicted meanwhile
      catalog_.remove(*key);
      continue;
    }
    const auto content = tile->read();
    --messages;
    if (!content) {
      unreadable_.add(*key, now);
      continue;
    }
    unreadable_.remove(*key);
    std::int32_t& sent = sent_[*key];
    const std::int32_t before = sent;
    const std::int32_t total = size_of(*content);
    sent = send_records(*key, *tile, *content, before, total);
    points -= sent - before;
    catalog_.set_version(*key, sent);
    if (sent == total) continue;
    if (changed_.is_far(*key))
      changed_.put_back(*key);
    else
      unfinished.push_back(*key);
  }
  for (const TileKey& key : unfinished) changed_.push(key);
}

void MapSender::send_requested(const dense_map::DenseMap& map) {
  for (const auto& [key, have] : catalog_.take_requests(kRequestsPerPeriod * static_cast<std::size_t>(periods_))) {
    const auto it = sent_.find(key);
    if (it == sent_.end()) continue;
    const dense_map::DenseTile* tile = map.tile(key);
    const auto content = tile == nullptr ? nullptr : tile->read();
    if (!content) continue;
    const std::int32_t end = std::min(it->second, size_of(*content));
    for (std::int32_t first = std::max(have, 0); first < end;)
      first = send_records(key, *tile, *content, first, size_of(*content));
  }
  if (const auto page = drive_.take_requested()) bus_.publish("MAP_TRAJECTORY", *page);
}

void MapSender::send_trajectory() {
  if (trajectory_.empty()) return;
  bus_.publish("MAP_TRAJECTORY", trajectory_.front());
  trajectory_.pop_front();
}

void MapSender::send_index(std::int64_t now, const Eigen::Vector3d& position) {
  changed_.set_position(position.x(), position.y());
  for (const tile_index_t& page : drive_.make_index(now)) bus_.publish("TILE_INDEX", page);
  for (const tile_index_t& page : catalog_.make_index(now, position.x(), position.y()))
    bus_.publish("TILE_INDEX", page);
}

void MapSender::finish(const dense_map::DenseMap& map) {
  while (!trajectory_.empty()) send_trajectory();
  while (const std::optional<TileKey> key = changed_.pop()) {
    const dense_map::DenseTile* tile = map.tile(*key);
    if (tile == nullptr) continue;
    const auto content = tile->read();
    if (!content) continue;
    std::int32_t& sent = sent_[*key];
    while (sent < size_of(*content)) sent = send_records(*key, *tile, *content, sent, size_of(*content));
    catalog_.set_version(*key, sent);
  }
}

}  // namespace curbstone::mapper
