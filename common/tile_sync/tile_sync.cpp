#include "common/tile_sync/tile_sync.hpp"

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <tuple>
#include <utility>

#include "common/time/has_passed.hpp"

namespace curbstone {

namespace {

/// A tile that may be announced in this round.
struct Entry {
  std::pair<int, double> rank;  // changed first, then near
  TileKey key;
  std::int32_t version;
};

bool by_rank(const Entry& a, const Entry& b) {
  return std::tie(a.rank, a.key) < std::tie(b.rank, b.key);
}

/// Limits the round to `max_tiles` tiles: half are the changed and the nearest ones, half are others in turn, beginning
/// after `turn`, so that every tile is announced at some time. Only the selected tiles are sorted. Returns the last
/// tile in turn.
TileKey limit_round(std::size_t max_tiles, TileKey turn, std::vector<Entry>& round) {
  const auto in_turn = [turn](const Entry& a, const Entry& b) {
    return std::pair(a.key <= turn, a.key) < std::pair(b.key <= turn, b.key);
  };
  const auto front = round.begin() + static_cast<std::ptrdiff_t>(max_tiles / 2);
  const auto end = round.begin() + static_cast<std::ptrdiff_t>(max_tiles);
  std::nth_element(round.begin(), front, round.end(), by_rank);
  std::nth_element(front, end - 1, round.end(), in_turn);
  const TileKey last = std::prev(end)->key;
  std::sort(round.begin(), front, by_rank);
  std::sort(front, end, in_turn);
  round.erase(end, round.end());
  return last;
}

/// Divides the round into pages; at least one, even if it is empty. `head`: the fields that all pages share.
std::vector<tile_index_t> to_pages(const std::vector<Entry>& round, const tile_index_t& head) {
  constexpr std::size_t kPerPage = TileCatalog::kTilesPerPage;
  std::vector<tile_index_t> pages(std::max<std::size_t>(1, (round.size() + kPerPage - 1) / kPerPage), head);
  for (std::size_t p = 0; p < pages.size(); ++p) {
    tile_index_t& page = pages[p];
    page.page = static_cast<std::int32_t>(p);
    page.num_pages = static_cast<std::int32_t>(pages.size());
    for (std::size_t i = p * kPerPage; i < std::min(round.size(), (p + 1) * kPerPage); ++i) {
      page.tile_x.push_back(round[i].key.x);
      page.tile_y.push_back(round[i].key.y);
      page.version.push_back(round[i].version);
    }
    page.num_tiles = static_cast<std::int32_t>(page.tile_x.size());
  }
  return pages;
}

}  // namespace

void TileCatalog::start_epoch(std::int32_t epoch) {
  epoch_ = epoch;
  versions_.clear();
  changed_.clear();
  waiting_.clear();
  waiting_have_.clear();
}

void TileCatalog::set_version(TileKey key, std::int32_t version) {
  versions_[key] = version;
  changed_.insert(key);
}

void TileCatalog::promise(TileKey key) {
  if (versions_.try_emplace(key, 0).second) changed_.insert(key);
}

void TileCatalog::remove(TileKey key) {
  versions_.erase(key);
  changed_.erase(key);
}

std::vector<tile_index_t> TileCatalog::make_index(std::int64_t utime, double x, double y, std::size_t max_tiles) {
  std::vector<Entry> round;
  round.reserve(versions_.size());
  for (const auto& [key, version] : versions_) {
    round.push_back({{changed_.contains(key) ? 0 : 1, squared_distance(key, x, y)}, key, version});
  }
  if (round.size() > max_tiles && max_tiles > 1)
    turn_ = limit_round(max_tiles, turn_, round);
  else
    std::sort(round.begin(), round.end(), by_rank);
  changed_.clear();

  tile_index_t head{};
  head.utime = utime;
  head.owner = owner_;
  head.channel = channel_;
  head.epoch = epoch_;
  return to_pages(round, head);
}

void TileCatalog::request(const tile_request_t& message) {
  if (message.channel != channel_ || message.epoch != epoch_) return;
  for (std::size_t i = 0; i < message.tile_x.size(); ++i) {
    const TileKey key{message.tile_x[i], message.tile_y[i]};
    if (!versions_.contains(key)) continue;
    const auto it = waiting_have_.find(key);
    if (it != waiting_have_.end()) {
      it->second = std::min(it->second, message.have[i]);
    } else if (waiting_.size() < kMaxWaiting) {
      waiting_.push_back(key);
      waiting_have_.emplace(key, message.have[i]);
    }
  }
}

std::vector<TileCatalog::Wanted> TileCatalog::take_requests(std::size_t max_tiles) {
  std::vector<Wanted> wanted;
  while (!waiting_.empty() && wanted.size() < max_tiles) {
    const TileKey key = waiting_.front();
    waiting_.pop_front();
    const std::int32_t have = waiting_have_.at(key);
    waiting_have_.erase(key);
    const auto it = versions_.find(key);
    if (it != versions_.end() && it->second > have) wanted.push_back({key, have});
  }
  return wanted;
}

void TileFollower::start_epoch(std::int32_t epoch) {
  epoch_ = epoch;
  have_.clear();
  behind_.clear();
}

void TileFollower::set_have(TileKey key, std::int32_t version) {
  have_[key] = version;
  const auto it = behind_.find(key);
  if (it != behind_.end() && it->second.announced <= version) behind_.erase(it);
}

void TileFollower::forget(TileKey key) {
  have_.erase(key);
  behind_.erase(key);
}

bool TileFollower::announced(const tile_index_t& message) {
  if (message.channel != channel_ || message.epoch != epoch_) return false;
  for (std::size_t i = 0; i < message.tile_x.size(); ++i) {
    const TileKey key{message.tile_x[i], message.tile_y[i]};
    const auto have = have_.find(key);
    if (have != have_.end() && have->second >= message.version[i]) continue;
    const auto [it, inserted] = behind_.try_emplace(key);
    if (inserted || it->second.announced == 0) it->second.since = message.utime;
    it->second.announced = std::max(it->second.announced, message.version[i]);
  }
  return true;
}

void TileFollower::lacks(TileKey key, std::int32_t version) {
  Behind& behind = behind_[key];
  behind.since = 0;
  behind.announced = std::max(behind.announced, version);
}

bool TileFollower::is_behind_near(double x, double y, double radius, std::int64_t until) const {
  return std::any_of(behind_.begin(), behind_.end(), [&](const auto& tile) {
    return tile.second.since <= until && squared_distance(tile.first, x, y) < radius * radius;
  });
}

tile_request_t TileFollower::make_request(std::int64_t now, std::size_t max_tiles, std::int64_t patience, double x,
                                          double y) {
  std::vector<TileKey> due;
  for (const auto& [key, behind] : behind_) {
    if (behind.announced == 0) continue;
    // `since` is another's stamp: a little ahead of this clock is no clock that was set back.
    if (std::abs(now - behind.since) >= patience && has_passed(1'000'000, behind.last_asked, now)) due.push_back(key);
  }
  std::sort(due.begin(), due.end(), [&](TileKey a, TileKey b) {
    return std::pair(squared_distance(a, x, y), a) < std::pair(squared_distance(b, x, y), b);
  });
  if (due.size() > max_tiles) due.resize(max_tiles);

  tile_request_t request;
  request.utime = now;
  request.requester = requester_;
  request.channel = channel_;
  request.epoch = epoch_;
  for (const TileKey& key : due) {
    behind_[key].last_asked = now;
    const auto have = have_.find(key);
    request.tile_x.push_back(key.x);
    request.tile_y.push_back(key.y);
    request.have.push_back(have == have_.end() ? 0 : have->second);
  }
  request.num_tiles = static_cast<std::int32_t>(due.size());
  return request;
}

}  // namespace curbstone
