#include "services/viewer/viewer_node.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <utility>

#include "common/bus/levels.hpp"
#include "common/geometry/geometry.hpp"
#include "common/tile_sync/pose_order.hpp"
#include "common/time/has_passed.hpp"

namespace curbstone::viewer {

namespace {

constexpr std::int64_t kRequestPeriod = 100'000;  // us
constexpr std::int64_t kServicesPeriod = 500'000;
constexpr std::int64_t kOldest = 60'000'000;  // us: older measurements are left out of the latency
constexpr float kAtOrigin = 2;                // m
constexpr std::size_t kMaxHeld = 64;          // pages of MAP_TRAJECTORY
constexpr std::size_t kMaxBehind = store::LiveMap::kMaxTiles;

double seconds_since(std::int64_t then, std::int64_t now) {
  if (then == 0) return std::numeric_limits<double>::quiet_NaN();
  return static_cast<double>(std::max<std::int64_t>(0, now - then)) * 1e-6;
}

/// Draws a random id of this process run, so that pages discard what they have from another run. It fits a double.
double draw_run() {
  std::random_device entropy;
  return static_cast<double>(std::uniform_int_distribution<std::int64_t>(1, std::int64_t{1} << 52)(entropy));
}

std::string requester(const ViewerNode::Source& source) {
  return "viewer:" + source.kind;
}

}  // namespace

ViewerNode::ViewerNode(const ViewerConfig& config, Publisher& bus, web::Connections& connections, Source source)
    : config_(config),
      bus_(bus),
      connections_(connections),
      source_(std::move(source)),
      run_(draw_run()),
      tiles_(requester(source_), "SEMANTIC_TILE"),
      scan_(config.vehicle.T_base_lidar(), config.scan_points),
      cloud_(requester(source_)) {}

void ViewerNode::connect(Subscriber& bus) {
  subscriber_ = &bus;
  bus.subscribe<semantic_tile_t>("SEMANTIC_TILE", [this](const semantic_tile_t& m) { on(m); });
  bus.subscribe<tile_index_t>("TILE_INDEX", [this](const tile_index_t& m) { on(m); });
  bus.subscribe<map_pose_t>("MAP_POSE", [this](const map_pose_t& m) { on(m); });
  bus.subscribe<map_pose_t>("LOCALIZED_POSE", [this](const map_pose_t& m) { on_localized(m); });
  bus.subscribe<map_trajectory_t>("MAP_TRAJECTORY", [this](const map_trajectory_t& m) { on(m); });
  bus.subscribe<curb_lines_t>("CURBS", [this](const curb_lines_t& m) { on(m); });
  bus.subscribe<marking_lines_t>("MARKINGS", [this](const marking_lines_t& m) { on(m); });
  bus.subscribe<service_status_t>("SERVICE_STATUS", [this](const service_status_t& m) { on(m); });
}

/// The LiDAR's points are most of the bus traffic, so they are subscribed to only while a page shows them.
void ViewerNode::watch_scan() {
  const auto shows_it = [](const auto& entry) { return entry.second.feed && entry.second.feed->wants_points(); };
  const bool is_wanted = scan_wanted_elsewhere_ || std::any_of(pages_.begin(), pages_.end(), shows_it);
  scan_points_.tick(now_, is_wanted, subscriber_);
}

void ViewerNode::watch_cloud() {
  CloudIntake::Wish wish;
  for (const auto& [id, page] : pages_) {
    if (page.feed) wish.add(page.feed->cloud_wish());
  }
  cloud_.tick(now_, wish, epochs_.epoch().value_or(0), pose_, subscriber_, bus_);
}

bool ViewerNode::follow_epoch(std::int32_t epoch, EpochFollower::Source source) {
  heard();
  const EpochFollower::Verdict verdict = epochs_.observe(epoch, source, now_);
  if (verdict == EpochFollower::Verdict::kEntered) enter_epoch(epoch);
  if (verdict == EpochFollower::Verdict::kEntered || verdict == EpochFollower::Verdict::kPresent) return true;
  counters_.add("dropped.other_epoch");
  return false;
}

void ViewerNode::forget_map() {
  map_.clear();
  steps_.clear(map_);
  curbs_.clear();
  markings_.clear();
  path_.clear();
  pose_.reset();
}

void ViewerNode::restart() {
  forget_map();
  cloud_.forget();
  run_ = draw_run();
  epochs_ = {};
  services_ = {};
  held_.clear();
  left_ = 0;
  localized_.reset();
  bus_heard_ = tile_heard_ = index_heard_ = pose_heard_ = newest_utime_ = 0;
  for (auto& [id, page] : pages_) {
    if (page.feed) page.feed->restart();
  }
}

/// A map that was corrected as a whole has the drive of the one before. A map in a frame of its own has only newer
/// poses, and begins at its origin; a drive whose MAP_TRAJECTORY was lost on the bus begins somewhere.
bool ViewerNode::is_new_map() const {
  if (left_ == 0 || path_.points().empty()) return false;
  const store::ThinnedPath::Point& first = path_.points().front();
  return first.utime > left_ && std::hypot(first.x, first.y) < kAtOrigin;
}

void ViewerNode::enter_epoch(std::int32_t epoch) {
  counters_.add("epochs");
  if (!is_new_map() && !path_.points().empty()) left_ = path_.points().back().utime;
  forget_map();
  tile_heard_ = index_heard_ = 0;
  tiles_.start_epoch(epoch);
  for (const map_trajectory_t& page : std::exchange(held_, {})) {
    if (page.epoch == epoch) take(page);
  }
}

void ViewerNode::on(const semantic_tile_t& message) {
  counters_.add("tiles_received");
  if (!follow_epoch(message.epoch, EpochFollower::Source::kOther)) return;
  const auto cells = store::cells_of(message);
  if (!cells) return counters_.add("refused.tile");
  const TileKey key{message.tile_x, message.tile_y};
  const store::TileCells* before = map_.at(key);
  if (before == nullptr || before->revision < cells->revision) steps_.will_change(key, before);
  switch (map_.put(key, *cells)) {
    case store::LiveMap::Put::kFull:
      return counters_.add("dropped.map_full");
    case store::LiveMap::Put::kKnown:
      return counters_.add("dropped.known");
    case store::LiveMap::Put::kTaken:
      break;
  }
  tiles_.set_have(key, cells->revision);
  tile_heard_ = now_;
  newest_utime_ = std::max(newest_utime_, cells->utime);
}

void ViewerNode::on(const tile_index_t& message) {
  cloud_.on(message);
  if (message.channel != "SEMANTIC_TILE") return heard();
  if (!follow_epoch(message.epoch, EpochFollower::Source::kOther)) return;
  index_heard_ = now_;
  index_position_ = playback_ ? playback_->position : 0;
  if (tiles_.behind() < kMaxBehind) tiles_.announced(message);
}

void ViewerNode::on(const map_pose_t& message) {
  const Pose T_map_base = pose_from_arrays(message.map_base_position, message.map_base_orientation);
  if (!is_finite(T_map_base) || message.utime <= 0) return counters_.add("refused.pose");
  if (!follow_epoch(message.epoch, EpochFollower::Source::kMapper)) return;
  if (pose_ && is_overtaken({message.utime, message.revolution}, {pose_->utime, pose_->revolution}))
    return counters_.add("dropped.late");
  pose_ = message;
  pose_heard_ = now_;
  const Eigen::Vector3f place = T_map_base.translation().cast<float>();
  if ((message.flags & map_pose_t::LOST) == 0) path_.append({message.utime, place.x(), place.y(), place.z()});
}

/// The pose is in the frame of the localizer's saved map, so its epoch is not an epoch of the live map.
void ViewerNode::on_localized(const map_pose_t& message) {
  const Pose T_map_base = pose_from_arrays(message.map_base_position, message.map_base_orientation);
  if (!is_finite(T_map_base) || message.utime <= 0) return counters_.add("refused.pose");
  heard();
  localized_ = message;
  localized_heard_ = now_;
}

void ViewerNode::on(const map_trajectory_t& message) {
  if (follow_epoch(message.epoch, EpochFollower::Source::kMapper)) return take(message);
  if (held_.size() < kMaxHeld) held_.push_back(message);
}

void ViewerNode::take(const map_trajectory_t& message) {
  for (std::size_t i = 0; i < message.utimes.size(); ++i) {
    const auto& place = message.positions[i];
    const bool is_sound =
        message.utimes[i] > 0 && std::all_of(place.begin(), place.end(), [](float v) { return std::isfinite(v); });
    if (is_sound)
      path_.put({message.utimes[i], place[0], place[1], place[2]});
    else
      counters_.add("refused.pose");
  }
}

void ViewerNode::on(const curb_lines_t& message) {
  take_lines(message, curbs_, "curbs");
}

void ViewerNode::on(const marking_lines_t& message) {
  take_lines(message, markings_, "markings");
}

template <class Message>
void ViewerNode::take_lines(const Message& message, store::BoxedLines<Message>& lines, const std::string& name) {
  using Put = typename store::BoxedLines<Message>::Put;
  if (!follow_epoch(message.epoch, EpochFollower::Source::kOther)) return;
  const Put put = lines.put(message);
  if (put != Put::kTaken) counters_.add(put == Put::kRefused ? "refused." + name : "dropped." + name + "_full");
}

void ViewerNode::on(const service_status_t& message) {
  if (!message.service.starts_with("viewer")) heard();  // the viewers' own status shows no other process
  if (!services_.put(message, now_)) counters_.add("dropped.service");
}

void ViewerNode::on(const lidar_points_t& message) {
  if (!lidar_.accept(message.utime, message.packet)) return counters_.add("refused.second_lidar");
  if (!scan_.put(message)) counters_.add("refused.points");
}

void ViewerNode::receive(const web::Connections::Event& event) {
  using Kind = web::Connections::Event::Kind;
  if (event.kind == Kind::kConnected) pages_.try_emplace(event.page);
  if (event.kind == Kind::kDisconnected) pages_.erase(event.page);
  const auto page = pages_.find(event.page);
  if (event.kind == Kind::kMessage && page != pages_.end()) receive(page->second, event);
}

void ViewerNode::receive(Page& page, const web::Connections::Event& event) {
  const PageRequest request = parse_page_request(event.text);
  if (request.resumes) {
    page.feed.emplace(request.has);
    page.sent = 0;
    return;
  }
  if (!page.feed) return counters_.add("refused.nonsense");
  if (request.drawn) return drawn(page, *request.drawn, event.at);
  if (request.play && source_.on_order) return source_.on_order(*request.play);
  if (request.points) return page.feed->want_points(*request.points);
  if (request.cloud) return page.feed->want_cloud(*request.cloud);
  counters_.add("refused.nonsense");
}

void ViewerNode::drawn(Page& page, std::uint32_t frame, std::int64_t at) {
  const auto newest = page.feed->drawn(frame);
  if (!newest) return counters_.add("refused.nonsense");
  if (*newest == 0 || at < *newest || at - *newest > kOldest) return;
  const double latency = static_cast<double>(at - *newest) * 1e-6;
  page.latency.add(latency);
  latency_.add(latency);
}

void ViewerNode::tick(std::int64_t now) {
  now_ = now;
  for (const web::Connections::Event& event : connections_.take_events()) receive(event);
  watch_scan();
  watch_cloud();
  if (has_passed(kRequestPeriod, last_request_, now)) {
    last_request_ = now;
    const tile_request_t request =
        pose_ ? tiles_.make_request(now, 200, 300'000, pose_->map_base_position[0], pose_->map_base_position[1])
              : tiles_.make_request(now);
    if (request.num_tiles > 0) bus_.publish("TILE_REQUEST", request);
  }
  if (!pages_.empty() && has_passed(kServicesPeriod, last_services_, now)) {
    last_services_ = now;
    services_json_ = services_json(services_, now);
    ++services_number_;
  }
  send_frames();
}

/// A page that is up to date gets a frame each period, even if nothing changed, so that silence means a dead
/// connection. A page that is behind gets one as soon as fewer than PageFeed::kMaxOut frames are unacknowledged.
void ViewerNode::send_frames() {
  const auto period = static_cast<std::int64_t>(config_.frame_period * 1e6);
  const auto is_due = [&](const Page& page) { return std::abs(now_ - page.sent) >= period; };
  const bool any_due =
      std::any_of(pages_.begin(), pages_.end(), [&](const auto& entry) { return is_due(entry.second); });
  if (any_due) steps_.close(map_);
  if (pages_.empty()) steps_.clear(map_);  // no page is up to date
  for (auto& [id, page] : pages_) {
    if (!page.feed || !page.feed->may_send()) continue;
    if (!is_due(page)) {
      if (!page.feed->is_behind(world())) continue;
      steps_.close(map_);
    }
    page.sent = now_;
    const std::string state = state_json(state_for(page), config_.vehicle);
    connections_.send(id, std::make_shared<std::vector<std::uint8_t>>(page.feed->make(world(), state)));
    counters_.add("frames");
  }
}

frames::World ViewerNode::world() const {
  return {.run = run_,
          .epoch = epochs_.epoch().value_or(0),
          .map = map_,
          .steps = steps_,
          .curbs = curbs_,
          .markings = markings_,
          .path = path_,
          .scan = scan_.points(),
          .scan_number = scan_.number(),
          .services = services_json_,
          .services_number = services_number_,
          .newest_utime = newest_utime_,
          .cloud = &cloud_.cloud(),
          .now = now_};
}

State ViewerNode::state_for(const Page& page) const {
  return {.source = source_.kind,
          .title = source_.title,
          .epoch = epochs_.epoch().value_or(0),
          .tiles = map_.size(),
          .behind = tiles_.behind(),
          .bus_age = seconds_since(bus_heard_, now_),
          .tile_age = seconds_since(tile_heard_, now_),
          .index_age = playback_ && index_heard_ != 0 ? std::max(0.0, playback_->position - index_position_)
                                                      : seconds_since(index_heard_, now_),
          .pose_age = seconds_since(pose_heard_, now_),
          .new_map_age = is_new_map() && pose_ ? seconds_since(path_.points().front().utime, pose_->utime)
                                               : std::numeric_limits<double>::quiet_NaN(),
          .latency_p50 = page.latency.percentile(0.5),
          .latency_p95 = page.latency.percentile(0.95),
          .pose = pose_,
          .localized = localized_,
          .localized_age = seconds_since(localized_heard_, now_),
          .playback = playback_};
}

NodeReport ViewerNode::report() const {
  NodeReport report{.counters = counters_, .faults = {}};
  report.counters.set(connections_.counters());
  report.counters.add(cloud_.counters());
  set_level(report.counters, "pages", static_cast<std::int64_t>(pages_.size()));
  set_level(report.counters, "tiles_behind", static_cast<std::int64_t>(tiles_.behind()));
  if (const auto fault = epochs_.fault(now_)) report.faults.push_back(*fault);
  report.latency_p50 = latency_.percentile(0.5);
  report.latency_p99 = latency_.percentile(0.99);
  return report;
}

}  // namespace curbstone::viewer
