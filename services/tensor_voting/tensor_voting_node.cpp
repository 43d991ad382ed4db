#include "services/tensor_voting/tensor_voting_node.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "services/tensor_voting/voted_pages.hpp"

namespace curbstone {

namespace {

constexpr const char* kMapPoints = "MAP_POINTS";
constexpr const char* kVotedPoints = "VOTED_POINTS";
constexpr std::int32_t kStepsPerMetre = 500;
constexpr std::int64_t kSecond = 1'000'000;           // us
constexpr std::int64_t kRequestInterval = 100'000;    // us
constexpr std::size_t kTilesPerRequest = 100;         // a few hundred kB of answers
constexpr std::size_t kMaxBehind = 20'000;            // tiles that we lack and know of
constexpr double kUnpublishedMargin = 2 * kTileSize;  // m: tiles at the rim may lack neighbours that were let go

std::int64_t microseconds(double seconds) {
  return static_cast<std::int64_t>(seconds * 1e6);
}

template <class Visit>
void for_each_around(TileKey key, Visit visit) {
  for (int i = 0; i < 9; ++i) visit(TileKey{key.x + i % 3 - 1, key.y + i / 3 - 1});
}

}  // namespace

TensorVotingNode::TensorVotingNode(const TensorVotingConfig& config, std::string worker, Publisher& publisher)
    : config_(config),
      worker_(std::move(worker)),
      publisher_(publisher),
      map_({.points = static_cast<std::size_t>(config.max_points)}),
      workers_(worker_, microseconds(config.worker_timeout)),
      follower_(worker_, kMapPoints),
      catalog_(worker_, kVotedPoints),
      schedule_({.min_interval = microseconds(config.min_interval), .patience = microseconds(config.patience)}) {
  for (const VotingParameters& scale : config.scales()) fields_.emplace_back(scale);
}

void TensorVotingNode::connect(Subscriber& bus) {
  bus.subscribe<map_points_t>(kMapPoints, [this](const map_points_t& m) { on(m); });
  bus.subscribe<map_pose_t>("MAP_POSE", [this](const map_pose_t& m) { on(m); });
  bus.subscribe<tile_index_t>("TILE_INDEX", [this](const tile_index_t& m) { on(m); });
  bus.subscribe<tile_request_t>("TILE_REQUEST", [this](const tile_request_t& m) { on(m); });
}

void TensorVotingNode::on(const map_points_t& message) {
  if (message.epoch < epoch_) {
    counters_.add("dropped.old_epoch");
    return;
  }
  if (message.epoch > epoch_) start_epoch(message.epoch);
  mapper_heard_ = now_;
  const TileKey key{message.tile_x, message.tile_y};
  if (!(distance(key) <= config_.keep_radius)) {
    counters_.add("dropped.far");
    return;
  }
  const PointTiles::Taken taken = map_.take(message);
  switch (taken.outcome) {
    case PointTiles::Outcome::kDuplicate:
      counters_.add("dropped.duplicate");
      return;
    case PointTiles::Outcome::kGap:
      counters_.add("dropped.gap");
      return;
    case PointTiles::Outcome::kRefused:
      counters_.add("refused.map_points");
      return;
    case PointTiles::Outcome::kFull:
      counters_.add("dropped.full");
      return;
    case PointTiles::Outcome::kAdded:
      break;
  }
  const PointTile& tile = *map_.find(key);
  follower_.set_have(key, static_cast<std::int32_t>(tile.points.size()));
  counters_.add("map_points", static_cast<std::int64_t>(taken.added.size()));
  if (!votes_here(key)) return;
  for (VotingField& field : fields_) field.add(key, tile.z_origin * kStepsPerMetre, taken.added);
}

void TensorVotingNode::on(const map_pose_t& message) {
  const double* p = message.map_base_position;
  if (!(std::abs(p[0]) < 1e7 && std::abs(p[1]) < 1e7)) {
    counters_.add("refused.map_pose");
    return;
  }
  x_ = p[0];
  y_ = p[1];
}

void TensorVotingNode::on(const tile_index_t& message) {
  if (message.channel == kVotedPoints && message.owner != worker_) {
    workers_.heard(message.owner, now_);
    if (message.epoch != epoch_) return;
    // What another worker has published need not be published again when its tiles become ours.
    for (std::size_t i = 0; i < message.version.size(); ++i) {
      schedule_.published({message.tile_x[i], message.tile_y[i]}, message.version[i], 0);
    }
  } else if (message.channel == kMapPoints) {
    if (message.epoch > epoch_) start_epoch(message.epoch);
    mapper_heard_ = now_;
    tile_index_t near = message;
    near.tile_x.clear(), near.tile_y.clear(), near.version.clear();
    for (std::size_t i = 0; i < message.version.size() && follower_.behind() < kMaxBehind; ++i) {
      if (!(distance({message.tile_x[i], message.tile_y[i]}) <= config_.keep_radius)) continue;
      near.tile_x.push_back(message.tile_x[i]);
      near.tile_y.push_back(message.tile_y[i]);
      near.version.push_back(message.version[i]);
    }
    near.num_tiles = static_cast<std::int32_t>(near.version.size());
    (void)follower_.announced(near);
  }
}

void TensorVotingNode::on(const tile_request_t& message) {
  catalog_.request(message);
}

void TensorVotingNode::start_epoch(std::int32_t epoch) {
  epoch_ = epoch;
  map_.clear();
  for (VotingField& field : fields_) field.clear();
  follower_.start_epoch(epoch);
  catalog_.start_epoch(epoch);
  schedule_.clear();
  pages_.clear();
}

double TensorVotingNode::distance(TileKey key) const {
  return std::hypot((key.x + 0.5) * kTileSize - x_, (key.y + 0.5) * kTileSize - y_);
}

bool TensorVotingNode::votes_here(TileKey key) const {
  bool any = false;
  for_each_around(key, [&](TileKey tile) { any = any || workers_.owns(tile); });
  return any;
}

bool TensorVotingNode::publishes(TileKey key) const {
  return workers_.owns(key) && distance(key) <= config_.keep_radius - kUnpublishedMargin;
}

std::int32_t TensorVotingNode::revision(TileKey key) const {
  const PointTile* const tile = map_.find(key);
  if (tile == nullptr) return 0;
  auto total = static_cast<std::int64_t>(tile->points.size());
  for (const VotingField& field : fields_) total += field.num_votes(key);
  return static_cast<std::int32_t>(std::min<std::int64_t>(total, std::numeric_limits<std::int32_t>::max()));
}

/// Puts a tile's revision before the schedule, if it is for us to publish.
void TensorVotingNode::review(TileKey key) {
  if (map_.find(key) == nullptr || !publishes(key)) return;
  const std::int32_t revision = this->revision(key);
  schedule_.changed(key, revision, now_);
  // Published before, by its owner of that time: now it is us who answers for it.
  if (schedule_.published_revision(key) == revision) catalog_.set_version(key, revision);
}

/// The set of live workers has changed: moves the tiles. Exact sums make that a matter of adding and removing.
void TensorVotingNode::reassign() {
  counters_.add("reassignments");
  for (const auto& [key, tile] : map_.tiles()) {
    const bool wanted = votes_here(key);
    for (VotingField& field : fields_) {
      if (wanted && !field.contains(key)) field.add(key, tile.z_origin * kStepsPerMetre, tile.points);
      if (!wanted) field.remove(key);
    }
  }
  for (const auto& [key, tile] : map_.tiles()) {
    if (workers_.owns(key)) {
      review(key);
    } else {
      schedule_.drop(key);
      catalog_.remove(key);
    }
  }
}

void TensorVotingNode::collect_changes() {
  for (VotingField& field : fields_) {
    for (const TileKey key : field.take_changed()) review(key);
  }
}

/// Lets go of what has fallen behind; takes up what has come near again.
void TensorVotingNode::follow_vehicle() {
  std::vector<TileKey> far;
  for (const auto& [key, tile] : map_.tiles()) {
    if (distance(key) <= config_.keep_radius) {
      if (distance(key) > config_.keep_radius - 2 * kUnpublishedMargin) review(key);
      continue;
    }
    bool waits = false;
    for_each_around(key, [&](TileKey around) { waits = waits || schedule_.is_pending(around); });
    if (!waits) far.push_back(key);
  }
  for (const TileKey key : far) {
    for (VotingField& field : fields_) field.remove(key);
    map_.erase(key);
    follower_.forget(key);
    catalog_.remove(key);
    counters_.add("tiles_let_go");
  }
}

void TensorVotingNode::announce() {
  for (const tile_index_t& page : catalog_.make_index(now_, x_, y_)) publisher_.publish("TILE_INDEX", page);
}

void TensorVotingNode::queue_pages(TileKey key) {
  const PointTile* const tile = map_.find(key);
  if (tile == nullptr) {
    schedule_.drop(key);
    return;
  }
  const std::int32_t revision = this->revision(key);
  // Its own points' time, not its neighbours': a fact of the content, like everything in the message.
  for (voted_points_t& page : make_voted_pages(key, *tile, epoch_, revision, tile->utime, fields_)) {
    pages_.push_back(std::move(page));
  }
  schedule_.published(key, revision, now_);
  catalog_.set_version(key, revision);
  counters_.add("tiles_published");
  counters_.add("points_published", static_cast<std::int64_t>(tile->points.size()));
  latency_.add(static_cast<double>(now_ - tile->utime) * 1e-6);
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

void TensorVotingNode::tick(std::int64_t now) {
  // A clock that jumps, or a replay that starts, gives no more budget than one late tick does.
  const auto elapsed = static_cast<double>(std::clamp<std::int64_t>(now - now_, 0, 50'000));
  const double per_tick = config_.bandwidth * elapsed;  // MB/s times us
  budget_ = std::min(budget_ + per_tick, std::max(per_tick, static_cast<double>(kMaxPageBytes)));
  now_ = now;

  if (workers_.update(now)) reassign();
  collect_changes();
  publish_paced();
  if (now - last_request_ >= kRequestInterval || now < last_request_) {
    last_request_ = now;
    const tile_request_t request = follower_.make_request(now, kTilesPerRequest);
    if (request.num_tiles > 0) publisher_.publish("TILE_REQUEST", request);
  }
  if (now - last_index_ >= kSecond || now < last_index_) {
    last_index_ = now;
    follow_vehicle();
    announce();
  }
}

void TensorVotingNode::finish() {
  collect_changes();
  while (const auto key = schedule_.any()) queue_pages(*key);
  while (!pages_.empty()) send_next_page();
  announce();
}

NodeReport TensorVotingNode::report() const {
  NodeReport report;
  report.counters = counters_;
  std::int64_t pairs = 0;
  for (const VotingField& field : fields_) pairs += field.num_pairs();
  report.counters.set("pair_votes", pairs);
  if (now_ - mapper_heard_ > 3 * kSecond) report.faults.push_back("the mapper is silent");
  if (counters_["dropped.full"] > 0) report.faults.push_back("max_points reached: new map points are not voted");
  report.latency_p50 = latency_.percentile(0.5);
  report.latency_p99 = latency_.percentile(0.99);
  return report;
}

}  // namespace curbstone
