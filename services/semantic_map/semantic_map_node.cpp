#include "services/semantic_map/semantic_map_node.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "common/bus/levels.hpp"
#include "common/time/has_passed.hpp"
#include "services/semantic_map/semantic_messages.hpp"

namespace curbstone::semantic_map {

namespace {

constexpr std::int64_t kTilePeriod = 100'000;   // us between two messages of a tile without new points
constexpr std::int64_t kCurbsPeriod = 200'000;  // us; linking the lines takes a millisecond
constexpr std::int64_t kMarkingsPeriod = 1'000'000;
constexpr std::int64_t kIndexPeriod = 1'000'000;
constexpr std::int64_t kWritePeriod = 1'000'000;
constexpr std::int64_t kStoreLinesPeriod = 5'000'000;  // all lines each time
constexpr std::int64_t kStoreLinesShare = 20;          // at most a twentieth of a core, however large the map is
constexpr std::int64_t kRequestPeriod = 100'000;
constexpr int kStoredAgainAtOnce = 5000;    // tiles, with each transaction
constexpr int kShownAtOnce = 32;            // tiles, about 10 ms: then new messages are taken
constexpr QueueLimit kVotedQueue = {3000};  // two seconds of messages, 20 MB: a process short of CPU catches up
constexpr std::size_t kAnswersPerTick = 4;
constexpr std::size_t kMaxTiles = 200'000;  // 1.8 square kilometres: bounds the memory

cells::ClassParameters with_vehicle(cells::ClassParameters classes, const VehicleConfig& vehicle) {
  classes.vehicle_height = vehicle.height;
  return classes;
}

/// In a file beside the map, or in memory if the map has no file.
std::shared_ptr<SpillFile> make_spill_file(const SemanticMapConfig& config) {
  if (config.map.empty()) return std::make_shared<SpillFile>();
  const std::filesystem::path folder = std::filesystem::path(config.map).parent_path();
  return std::make_shared<SpillFile>(folder.empty() ? "." : folder.string(),
                                     static_cast<std::uint64_t>(config.keep_free * 1e9));
}

/// Revision of a tile: counts up from the second in which the epoch began (the epoch's name), faster than a tile is
/// published. A restarted service thus continues above the revisions that it sent before. An epoch may last for a year.
std::int32_t revision_at(std::int64_t now, std::int32_t epoch) {
  constexpr std::int64_t kStep = 20'000;
  const std::int64_t begin = std::int64_t{epoch} * 1'000'000;
  return static_cast<std::int32_t>(std::clamp<std::int64_t>((now - begin) / kStep, 0, 2'000'000'000));
}

}  // namespace

SemanticMapNode::SemanticMapNode(const SemanticMapConfig& config, Publisher& bus, store::UnusableFile unusable)
    : config_(config),
      bus_(bus),
      spill_file_(make_spill_file(config)),
      pipeline_(config.curb, with_vehicle(config.classes, config.vehicle), config.markings, spill_file_),
      schedule_(config.work_per_tick),
      keeper_(config.map, static_cast<std::size_t>(config.max_pending_tiles), config.keep_earlier_drives, unusable),
      linker_(config.markings),
      nearby_curbs_(config.curb_range),
      nearby_markings_(config.curb_range, config.markings) {}

void SemanticMapNode::connect(Subscriber& bus) {
  bus.subscribe<voted_points_t>(
      "VOTED_POINTS", [this](voted_points_t& m) { on(std::move(m)); }, kVotedQueue);
  bus.subscribe<tile_index_t>("TILE_INDEX", [this](const tile_index_t& m) { on(m); });
  bus.subscribe<tile_request_t>("TILE_REQUEST", [this](const tile_request_t& m) { on(m); });
  bus.subscribe<map_pose_t>("MAP_POSE", [this](const map_pose_t& m) { on(m); });
  bus.subscribe<map_trajectory_t>("MAP_TRAJECTORY", [this](const map_trajectory_t& m) { on(m); });
}

bool SemanticMapNode::follow_epoch(std::int32_t epoch, EpochFollower::Source source) {
  switch (epochs_.observe(epoch, source, now_)) {
    case EpochFollower::Verdict::kPresent:
      return true;
    case EpochFollower::Verdict::kEntered:
      enter_epoch(epoch);
      return true;
    case EpochFollower::Verdict::kCandidate:
    case EpochFollower::Verdict::kOther:
      break;
  }
  return false;
}

void SemanticMapNode::enter_epoch(std::int32_t epoch) {
  if (has_epoch_) counters_.add("epochs");
  has_epoch_ = true;
  epoch_ = epoch;
  drive_started_ = false;
  last_pose_ = {};
  lost_timer_.clear();
  assembler_.clear();
  pipeline_.clear();
  schedule_.clear();
  unsent_.clear();
  unstored_.clear();
  published_.clear();
  revisions_.clear();
  path_.clear();
  linker_.clear();
  voted_.start_epoch(epoch);
  drive_.start_epoch(epoch);
  catalog_.start_epoch(epoch);
  curbs_changed_ = lines_unstored_ = true;
  markings_changed_ = config_.markings.enabled;
  for (const PendingTrajectory::Message& held : pending_trajectory_.take(epoch))
    std::visit([this](const auto& message) { take(message); }, held);
}

void SemanticMapNode::on(voted_points_t message) {
  counters_.add("voted_pages");
  if (!follow_epoch(message.epoch, EpochFollower::Source::kOther)) return counters_.add("dropped.other_epoch");
  const TileKey key{message.tile_x, message.tile_y};
  const auto revision = revisions_.find(key);
  if (revision != revisions_.end() && message.revision <= revision->second) return counters_.add("dropped.known");
  if (revision == revisions_.end() && revisions_.size() >= kMaxTiles) return counters_.add("dropped.map_full");
  const auto step = assembler_.add(std::move(message), counters_);
  if (!step) return;
  const auto change = pipeline_.apply(*step);
  if (!change) {
    if (voted_.behind() < kMaxTiles) voted_.lacks(key, step->revision);
    return counters_.add("dropped.gap");
  }
  counters_.add("voted_tiles");
  newest_utime_ = std::max(newest_utime_, change->utime);
  revisions_[key] = change->revision;
  voted_.set_have(key, change->revision);
  schedule_.voted(*change, now_);
}

void SemanticMapNode::on(const tile_index_t& message) {
  drive_.announced(message);
  if (message.channel != "VOTED_POINTS") return;
  if (!follow_epoch(message.epoch, EpochFollower::Source::kOther)) return counters_.add("dropped.other_epoch");
  voted_.announced(message);
}

void SemanticMapNode::on(const tile_request_t& message) {
  catalog_.request(message);
}

void SemanticMapNode::caught_up(std::int64_t now) {
  if (schedule_.num_waiting() == 0) return;
  now_ = now;
  show_new_points(now);
}

bool SemanticMapNode::idle(std::int64_t now) {
  now_ = now;
  idles_ = true;
  if (show_next(now)) return true;
  const auto changed = work_on_one(now);
  if (!changed) return false;
  publish_changed(*changed, now);
  return true;
}

void SemanticMapNode::tick(std::int64_t now) {
  now_ = now;
  pipeline_.set_time(now);
  show_new_points(now);
  if (!idles_) publish_changed(work_on_all(now), now);
  std::erase_if(unsent_, [&](TileKey key) { return publish_if_due(key, now); });
  answer_requests();
  if (has_passed(kRequestPeriod, last_request_, now)) send_requests(now);
  if (has_points() && curbs_changed_ && has_passed(kCurbsPeriod, last_curbs_, now)) publish_curbs(now);
  if (has_points() && markings_changed_ && has_passed(kMarkingsPeriod, last_markings_, now)) publish_markings(now);
  if (has_passed(kIndexPeriod, last_index_, now)) publish_index(now);
  settle_while_lost();
  if (has_passed(kWritePeriod, last_write_, now)) {
    last_write_ = now;
    if (drive_started_) store(now);
  }
}

void SemanticMapNode::request_lost_tiles() {
  for (const TileKey key : pipeline_.take_lost()) {
    counters_.add("faults.far_tiles");
    const auto revision = revisions_.extract(key);
    voted_.forget(key);
    if (!revision.empty()) voted_.lacks(key, revision.mapped());
  }
}

void SemanticMapNode::send_requests(std::int64_t now) {
  last_request_ = now;
  request_lost_tiles();
  const tile_request_t tiles = voted_.make_request(now);
  if (tiles.num_tiles > 0) bus_.publish("TILE_REQUEST", tiles);
  if (!drive_started_) return;
  const tile_request_t poses = drive_.make_request(now);
  if (poses.num_tiles > 0) bus_.publish("TILE_REQUEST", poses);
}

/// At most kShownAtOnce tiles, so that a process short of CPU takes its messages in between and loses none. A tile that
/// waits longer includes more of them.
void SemanticMapNode::show_new_points(std::int64_t now) {
  for (int i = 0; i < kShownAtOnce && show_next(now); ++i) {
  }
}

bool SemanticMapNode::show_next(std::int64_t now) {
  const auto work = schedule_.next_to_show();
  if (!work) return false;
  publish_changed(pipeline_.run(*work).changed, now);
  return true;
}

std::optional<std::set<TileKey>> SemanticMapNode::work_on_one(std::int64_t now) {
  const auto work = schedule_.next_work(vehicle_, pipeline_.backlog(), now);
  if (!work) return std::nullopt;
  pipeline::WorkResult result = pipeline_.run(*work);
  schedule_.spent(result.cost);
  if (result.markings) markings_changed_ = lines_unstored_ = true;
  return std::move(result.changed);
}

std::set<TileKey> SemanticMapNode::work_on_all(std::int64_t now) {
  std::set<TileKey> changed;
  while (auto more = work_on_one(now)) changed.merge(*more);
  return changed;
}

void SemanticMapNode::publish_changed(const std::set<TileKey>& changed, std::int64_t now) {
  for (const TileKey& key : changed) {
    if (!publish_if_due(key, now)) unsent_.insert(key);
  }
}

/// A tile with new points is published at once, and again when its curbs include them; a tile that only its neighbours
/// changed is published less often.
bool SemanticMapNode::publish_if_due(TileKey key, std::int64_t now) {
  const auto it = published_.find(key);
  const auto tile = pipeline_.classes(key);
  const bool is_newer = it == published_.end() || tile->utime > it->second.tile->utime ||
                        tile->curbs_utime > it->second.tile->curbs_utime;
  if (!is_newer && std::abs(now - it->second.at) < kTilePeriod) return false;
  publish_tile(tile, now);
  return true;
}

void SemanticMapNode::publish_tile(const std::shared_ptr<const tile::MapTile>& tile, std::int64_t now) {
  Published& published = published_[tile->key];
  if (published.tile && *published.tile == *tile) return;  // it changed and changed back
  const bool is_newer = !published.tile || tile->utime > published.tile->utime;
  published.at = now;
  published.tile = tile;
  published.revision = std::max(published.revision + 1, revision_at(now, epoch_));
  catalog_.set_version(tile->key, published.revision);
  keeper_.put(*tile);
  publish(published);
  curbs_changed_ = lines_unstored_ = true;
  counters_.add("tiles_updated");
  if (is_newer && now > tile->utime && now - tile->utime < 60'000'000)
    latency_.add(static_cast<double>(now - tile->utime) * 1e-6);
}

void SemanticMapNode::publish(const Published& published) {
  bus_.publish("SEMANTIC_TILE", to_message(*published.tile, epoch_, published.revision));
}

void SemanticMapNode::answer_requests() {
  for (const TileCatalog::Wanted& wanted : catalog_.take_requests(kAnswersPerTick)) {
    const auto it = published_.find(wanted.key);
    if (it != published_.end()) publish(it->second);
  }
}

void SemanticMapNode::publish_index(std::int64_t now) {
  last_index_ = now;
  for (const tile_index_t& page : catalog_.make_index(now, vehicle_.x(), vehicle_.y()))
    bus_.publish("TILE_INDEX", page);
}

void SemanticMapNode::publish_curbs(std::int64_t now) {
  last_curbs_ = now;
  curbs_changed_ = false;
  curbs_from_ = vehicle_;
  markings_changed_ = config_.markings.enabled;  // paint on kerbstones is not a marking
  curb_lines_t message = nearby_curbs_.next(pipeline_, vehicle_, path_);
  message.utime = newest_utime_;
  message.epoch = epoch_;
  bus_.publish("CURBS", message);
}

void SemanticMapNode::publish_markings(std::int64_t now) {
  last_markings_ = now;
  markings_changed_ = false;
  markings_from_ = vehicle_;
  marking_lines_t message = nearby_markings_.next(pipeline_, nearby_curbs_.lines(), vehicle_, path_);
  message.utime = newest_utime_;
  message.epoch = epoch_;
  bus_.publish("MARKINGS", message);
}

/// The map file was lost in mid-drive, and another has been begun. The tiles are put into it some at a time, since a
/// failing disk may let only so many wait; the poses come again from the mapper.
void SemanticMapNode::store_again() {
  if (keeper_.take_lost()) {
    for (const auto& [key, published] : published_) unstored_.insert(key);
    drive_.start_epoch(epoch_);
    lines_unstored_ = true;
  }
  for (int i = 0; i < kStoredAgainAtOnce && !unstored_.empty() && !keeper_.failing(); ++i)
    keeper_.put(*published_.at(unstored_.extract(unstored_.begin()).value()).tile);
}

void SemanticMapNode::store(std::int64_t now) {
  store_again();
  // The writing thread may be linking lines, and the linker must not run twice at a time.
  if (lines_unstored_ && keeper_.keeps() && !keeper_.busy() &&
      has_passed(std::max(kStoreLinesPeriod, kStoreLinesShare * keeper_.linking_took()), last_lines_stored_, now)) {
    last_lines_stored_ = now;
    lines_unstored_ = false;
    keeper_.put(linker_.link_snapshot(pipeline_, keeper_.previous_lines()));
  }
  keeper_.write();
}

NodeReport SemanticMapNode::report() const {
  NodeReport report;
  report.counters = counters_;
  report.counters.set(keeper_.counters());
  set_level(report.counters, "store.failing", keeper_.failing() ? 1 : 0);
  set_level(report.counters, "tiles", static_cast<std::int64_t>(pipeline_.num_tiles()));
  set_level(report.counters, "tiles_waiting", static_cast<std::int64_t>(schedule_.num_waiting() + unsent_.size()));
  set_level(report.counters, "steps_stale", static_cast<std::int64_t>(pipeline_.num_stale()));
  report.counters.set("evidence_computed", pipeline_.num_evidence());
  if (const auto fault = epochs_.fault(now_)) report.faults.push_back(*fault);
  if (const auto fault = drive_.fault(); fault && drive_started_) report.faults.push_back(*fault);
  set_level(report.counters, "far.memory_kb", static_cast<std::int64_t>(spill_file_->bytes_in_memory() / 1024));
  set_level(report.counters, "far.disk_kb", static_cast<std::int64_t>(spill_file_->bytes_in_file() / 1024));
  if (!spill_file_->fault().empty()) report.faults.push_back("far tiles stay in memory: " + spill_file_->fault());
  if (!keeper_.fault().empty()) report.faults.push_back(keeper_.fault());
  if (!picture_fault_.empty()) report.faults.push_back(picture_fault_);
  report.latency_p50 = latency_.percentile(0.5);
  report.latency_p99 = latency_.percentile(0.99);
  return report;
}

}  // namespace curbstone::semantic_map
