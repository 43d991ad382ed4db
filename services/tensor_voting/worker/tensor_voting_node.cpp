#include "services/tensor_voting/worker/tensor_voting_node.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/time/has_passed.hpp"
#include "common/time/microseconds.hpp"

namespace curbstone::tensor_voting::worker {

namespace {

constexpr const char* kMapPoints = "MAP_POINTS";
constexpr const char* kVotedPoints = "VOTED_POINTS";
constexpr std::int64_t kSecond = 1'000'000;          // us
constexpr std::int64_t kMapperSilent = 3 * kSecond;  // us: three of its indexes
constexpr std::int64_t kRequestInterval = 100'000;   // us
constexpr std::int64_t kRequestPatience = 300'000;   // us
constexpr std::size_t kTilesPerRequest = 100;        // for each interval: a few hundred kB of answers
constexpr std::int64_t kMaxIntervals = 20;           // in one request: a replay ticks every 2 s
constexpr std::size_t kMaxBehind = 20'000;           // tiles that this worker knows to lack
constexpr double kBurst = 50'000;            // us of bandwidth that may be saved up: the changes of a revolution
constexpr std::size_t kMovesPerTick = 8000;  // points processed in a takeover: 10 to 20 ms of work
constexpr std::int64_t kListen = 1'500'000;  // us: long enough for a heartbeat of every other worker
constexpr std::size_t kAtOnce = 300;         // tiles: some 12 MB, while nothing else is sent
constexpr double kJoinRadius = 40.0;         // m: what a worker must have around the vehicle before it joins

/// The start of a chain number: differs for each worker and for each start of it.
std::int64_t begin_chain(const std::string& worker, std::int64_t now) {
  return static_cast<std::int64_t>(std::hash<std::string>{}(worker + "@" + std::to_string(now)) | 1);
}

}  // namespace

TensorVotingNode::TensorVotingNode(const TensorVotingConfig& config, std::string worker, Publisher& publisher)
    : config_(config),
      worker_(std::move(worker)),
      publisher_(publisher),
      map_({.points = static_cast<std::size_t>(config.max_points)}, config.scales()),
      workers_(worker_, microseconds(config.worker_timeout)),
      follower_(worker_, kMapPoints),
      catalog_(worker_, kVotedPoints),
      schedule_({.min_interval = microseconds(config.min_interval)}) {}

void TensorVotingNode::connect(Subscriber& bus) {
  bus.subscribe<map_points_t>(kMapPoints, [this](const map_points_t& m) { on(m); });
  bus.subscribe<map_pose_t>("MAP_POSE", [this](const map_pose_t& m) { on(m); });
  bus.subscribe<tile_index_t>("TILE_INDEX", [this](const tile_index_t& m) { on(m); });
  bus.subscribe<tile_request_t>("TILE_REQUEST", [this](const tile_request_t& m) { on(m); });
}

void TensorVotingNode::on(const map_points_t& message) {
  if (!follow_epoch(message.epoch, EpochFollower::Source::kOther)) return;
  mapper_silence_.heard();
  const TileKey key{message.tile_x, message.tile_y};
  if (!is_near(key)) {
    // Only tiles that the mapper has announced: a damaged message may name any tile.
    const bool is_announced = follower_.is_behind(key) || map_.points().find(key) != nullptr;
    if (!is_announced || !is_unpublished(key)) return counters_.add("dropped.far");
    far_heard_[key] = now_;
  }
  const PointTiles::Taken taken = map_.take(message, votes_here(key));
  switch (taken.outcome) {
    case PointTiles::Outcome::kDuplicate:
      counters_.add("dropped.known");
      return;
    case PointTiles::Outcome::kGap:
      if (!full_.contains(key)) return counters_.add("dropped.gap");
      [[fallthrough]];  // behind records that did not fit
    case PointTiles::Outcome::kFull:
      counters_.add("dropped.full", message.num_points);
      return mute(key, message.first + message.num_points);
    case PointTiles::Outcome::kRefused:
      counters_.add("refused.map_points");
      return;
    case PointTiles::Outcome::kAdded:
      break;
  }
  follower_.set_have(key, map_.points().find(key)->records);
  counters_.add("map_points", static_cast<std::int64_t>(taken.added.size()));
  counters_.add("tiles_thinned", taken.removed ? 1 : 0);
  if (taken.removed) bases_.erase(key);  // its points have changed: the next publication is the whole tile
}

void TensorVotingNode::on(const map_pose_t& message) {
  const double* p = message.map_base_position;
  if (!(std::abs(p[0]) < 1e7 && std::abs(p[1]) < 1e7)) {
    counters_.add("refused.map_pose");
    return;
  }
  if (!follow_epoch(message.epoch, EpochFollower::Source::kMapper)) return;
  x_ = p[0];
  y_ = p[1];
  lost_timer_.on_pose(message.utime, (message.flags & map_pose_t::LOST) != 0);
}

void TensorVotingNode::on(const tile_index_t& message) {
  if (message.channel == kVotedPoints && message.owner != worker_) {
    workers_.on_heartbeat(message.owner, now_);
    if (message.epoch != epoch_) return;
    // A tile published by another worker need not be published again when this worker becomes its owner.
    for (std::size_t i = 0; i < message.version.size(); ++i) {
      const TileKey key{message.tile_x[i], message.tile_y[i]};
      schedule_.published(key, message.version[i], 0);
    }
  } else if (message.channel == kMapPoints) {
    if (!follow_epoch(message.epoch, EpochFollower::Source::kMapper)) return;
    mapper_silence_.heard();
    tile_index_t near = message;
    near.tile_x.clear(), near.tile_y.clear(), near.version.clear();
    for (std::size_t i = 0; i < message.version.size() && follower_.behind() < kMaxBehind; ++i) {
      const TileKey key{message.tile_x[i], message.tile_y[i]};
      if (!is_near(key) && !is_unpublished(key)) continue;
      near.tile_x.push_back(message.tile_x[i]);
      near.tile_y.push_back(message.tile_y[i]);
      near.version.push_back(message.version[i]);
    }
    near.num_tiles = static_cast<std::int32_t>(near.version.size());
    (void)follower_.announced(near);
    if (!index_heard_ && message.page == message.num_pages - 1) index_heard_ = message.utime;
  }
}

void TensorVotingNode::on(const tile_request_t& message) {
  catalog_.request(message);
}

/// Whether a message that names `epoch` is of the present epoch, which may begin with this message.
bool TensorVotingNode::follow_epoch(std::int32_t epoch, EpochFollower::Source source) {
  switch (epochs_.observe(epoch, source, now_)) {
    case EpochFollower::Verdict::kEntered:
      start_epoch(epoch);
      return true;
    case EpochFollower::Verdict::kPresent:
      return true;
    case EpochFollower::Verdict::kCandidate:
    case EpochFollower::Verdict::kOther:
      counters_.add("dropped.other_epoch");
  }
  return false;
}

void TensorVotingNode::start_epoch(std::int32_t epoch) {
  epoch_ = epoch;
  map_.clear();
  index_heard_.reset();
  follower_.start_epoch(epoch);
  catalog_.start_epoch(epoch);
  schedule_.clear();
  pages_.clear();
  bases_.clear();
  far_heard_.clear();
  full_.clear();
  lost_timer_.clear();
}

bool TensorVotingNode::owns(TileKey key) const {
  return workers_.count() == 1 || (joined_ && workers_.owns(key));
}

bool TensorVotingNode::votes_here(TileKey key) const {
  bool any = false;
  for_each_around(key, [&](TileKey tile) { any = any || owns(tile); });
  return any;
}

bool TensorVotingNode::publishes(TileKey key) const {
  return owns(key) && (distance(key) <= config_.keep_radius - kRim || has_neighbours(key));
}

/// Schedules a tile's revision if this worker publishes the tile.
void TensorVotingNode::review(TileKey key) {
  const PointTile* const tile = map_.points().find(key);
  if (tile == nullptr || !publishes(key) || !map_.is_current(key)) return;
  const std::int32_t revision = map_.revision(key);
  schedule_.changed(key, revision, tile->utime, now_);
  // Already published by a previous owner: this worker now answers requests for it.
  if (schedule_.published_revision(key) == revision) catalog_.set_version(key, revision);
}

/// A worker may join if it is alone, or if it has everything near the vehicle that the first index announced. Points
/// mapped since then may be on their way, or lost, as for a worker that joined long ago.
bool TensorVotingNode::may_join() const {
  if (!has_passed(kListen, first_tick_, now_)) return false;
  return workers_.count() == 1 || (index_heard_ && !follower_.is_behind_near(x_, y_, kJoinRadius, *index_heard_));
}

/// The ownership of tiles has changed. With exact sums, tiles are simply added and removed.
void TensorVotingNode::reassign() {
  counters_.add("reassignments");
  map_.reassign([this](TileKey key) { return votes_here(key); }, x_, y_);
  for (const auto& [key, tile] : map_.points().tiles()) {
    if (owns(key)) {
      review(key);
    } else {
      schedule_.drop(key);
      catalog_.remove(key);
      bases_.erase(key);
    }
  }
}

void TensorVotingNode::collect_changes() {
  for (const TileKey key : map_.take_changed()) review(key);
}

void TensorVotingNode::announce() {
  for (const tile_index_t& page : catalog_.make_index(now_, x_, y_)) publisher_.publish("TILE_INDEX", page);
}

void TensorVotingNode::queue_pages(TileKey key) {
  const PointTile* const tile = map_.points().find(key);
  // Scheduled again when the missing votes are computed. Without those of a released neighbour it must not go out.
  if (tile == nullptr || !map_.is_current(key) || !publishes(key)) {
    schedule_.drop(key);
    return;
  }
  const std::int32_t revision = map_.revision(key);
  VotedBase& base = bases_[key];
  if (schedule_.is_wanted(key)) base = {};
  for (voted_points_t& page : make_voted_pages(key, *tile, revision, base, map_.fields())) {
    page.epoch = epoch_;
    page.chain = chain_;
    pages_.push_back(std::move(page));
  }
  latency_.add(static_cast<double>(now_ - schedule_.waiting_since(key).value_or(now_)) * 1e-6);
  schedule_.published(key, revision, now_);
  catalog_.set_version(key, revision);
  counters_.add("tiles_published");
  counters_.add("points_published", static_cast<std::int64_t>(tile->points.size()));
}

void TensorVotingNode::send_next_page() {
  const int size = pages_.front().getEncodedSize();
  publisher_.publish(kVotedPoints, pages_.front());
  pages_.pop_front();
  budget_ -= size;
  counters_.add("bytes_published", size);
}

void TensorVotingNode::publish_paced() {
  for (const TileCatalog::Wanted& wanted : catalog_.take_requests(20)) schedule_.wanted(wanted.key, now_);
  while (budget_ > 0) {
    if (pages_.empty()) {
      const auto key = schedule_.next(now_, x_, y_);
      if (!key) return;
      queue_pages(*key);
    } else {
      send_next_page();
    }
  }
}

/// Advances the clock and earns bandwidth for the elapsed time.
void TensorVotingNode::advance(std::int64_t now) {
  // A clock that jumps, or a replay that starts, earns at most as much as one late tick.
  const auto elapsed = static_cast<double>(std::clamp<std::int64_t>(now - now_, 0, 50'000));
  const double earned = config_.bandwidth * elapsed;  // MB/s times us
  const double burst = std::max({earned, config_.bandwidth * kBurst, static_cast<double>(kMaxPageBytes)});
  budget_ = std::min(budget_ + earned, burst);
  now_ = now;
  map_.set_time(now);
}

void TensorVotingNode::caught_up(std::int64_t now) {
  if (first_tick_ == 0) return;
  advance(now);
  collect_changes();
  publish_paced();
}

void TensorVotingNode::tick(std::int64_t now) {
  advance(now);
  mapper_silence_.tick(now);
  if (first_tick_ == 0 || now < first_tick_) first_tick_ = now;
  if (chain_ == 0) chain_ = begin_chain(worker_, now);

  const bool others = workers_.update(now);
  const bool joins = !joined_ && may_join();
  if (joins) {
    joined_ = true;
    last_index_ = 0;  // sends an index at once
  }
  if (others || (joins && workers_.count() > 1)) reassign();
  map_.move(kMovesPerTick);
  collect_changes();
  if (is_over_ || (lost_timer_.take() && schedule_.num_pending() <= kAtOnce)) publish_all();
  publish_paced();
  if (has_passed(kRequestInterval, last_request_, now)) {
    const auto intervals = std::clamp<std::int64_t>((now - last_request_) / kRequestInterval, 1, kMaxIntervals);
    last_request_ = now;
    const tile_request_t request =
        follower_.make_request(now, kTilesPerRequest * static_cast<std::size_t>(intervals), kRequestPatience, x_, y_);
    if (request.num_tiles > 0) publisher_.publish("TILE_REQUEST", request);
  }
  if (has_passed(kSecond, last_index_, now)) {
    last_index_ = now;
    follow_vehicle();
    unmute();
    if (joined_) announce();
  }
}

void TensorVotingNode::publish_all() {
  while (map_.is_moving()) map_.move(kMovesPerTick);
  collect_changes();
  while (const auto key = schedule_.any()) queue_pages(*key);
  while (!pages_.empty()) send_next_page();
}

/// A far tile whose neighbours are still to come again is neither behind nor scheduled.
std::size_t TensorVotingNode::num_outstanding() const {
  const auto is_unpublished = [this](const auto& tile) {
    return owns(tile.first) && schedule_.published_revision(tile.first) == 0;
  };
  const auto& tiles = map_.points().tiles();
  return follower_.behind() + pages_.size() +
         static_cast<std::size_t>(std::count_if(tiles.begin(), tiles.end(), is_unpublished));
}

void TensorVotingNode::finish() {
  publish_all();
  announce();
}

NodeReport TensorVotingNode::report() const {
  NodeReport report;
  report.counters = counters_;
  report.counters.set("pair_votes", map_.num_pairs());
  if (mapper_silence_.silent() > kMapperSilent) report.faults.push_back("the mapper is silent");
  if (const auto fault = epochs_.fault(now_)) report.faults.push_back(*fault);
  if (!full_.empty())
    report.faults.push_back(fmt::format(
        "max_points reached: {} tiles have points that are not voted, and are missing in the map", full_.size()));
  report.latency_p50 = latency_.percentile(0.5);
  report.latency_p99 = latency_.percentile(0.99);
  return report;
}

}  // namespace curbstone::tensor_voting::worker
