#include "services/localizer/localizer_node.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <curbstone/map_pose_t.hpp>
#include <iterator>
#include <utility>

#include "common/time/clock.hpp"
#include "common/time/microseconds.hpp"
#include "services/localizer/monte_carlo/particle_filter.hpp"
#include "services/localizer/tracking/pose_on_ground.hpp"
#include "services/localizer/tracking/tracker.hpp"
#include "services/mapper/scan/odometry_intake.hpp"
#include "services/semantic_map/store/map_store.hpp"

namespace curbstone::localizer {
namespace {

constexpr std::size_t kMaxPending = 80;  // revolutions that wait for odometry; 20 Hz: 4 s
constexpr int kLidarGone = 400;          // packets in a row of another LiDAR: half a second, more than any burst
constexpr double kSteadyFor = 0.5;       // s for which the last motion is assumed to continue without odometry
constexpr double kMaxSpeed = 40.0;       // m/s: faster odometry has started anew
constexpr double kMaxTurn = 6.0;         // rad/s
constexpr double kStartTilt = 0.02;      // rad, 1 sigma of roll and pitch at the start
constexpr double kStartHeight = 0.15;    // m
constexpr double kUnknown = 1000.0;      // m and rad, 1 sigma of an unknown pose

}  // namespace

LocalizerNode::LocalizerNode(const LocalizerConfig& config, Publisher& bus)
    : config_(config), bus_(bus), file_(config.map), lidar_(kLidarGone), global_localizer_(config.tracking) {
  if (!config_.start.empty() && config_.start.size() != 3)
    throw ConfigError(fmt::format("localizer.start: expected X, Y, YAW or none, got {} numbers", config_.start.size()));
  if (config_.method == Method::kMonteCarlo && config_.start.empty())
    throw ConfigError("localizer.start: method mcl needs the place where the drive begins");
  const semantic_map::store::MapReader::Moment now(file_);
  epoch_ = file_.epoch();
  const auto keys = file_.tile_keys();
  map_.emplace(keys, [this](TileKey key) { return read(key); });
  map_->set_paint(fields::PaintField(file_.markings()));
  is_checked_ = true;
  if (map_->num_tiles() == 0)
    throw semantic_map::store::MapStoreError(config_.map + ": holds no tiles to find the vehicle by");
}

/// At the start a damaged map is refused. Later, the localizer continues without the tile.
std::optional<semantic_map::tile::MapTile> LocalizerNode::read(TileKey key) {
  if (is_replaced_) return std::nullopt;
  try {
    auto tile = file_.tile(key);
    // Asked behind the tile, which may be the first of another drive, in a frame of its own.
    is_replaced_ = is_checked_ && file_.epoch() != epoch_;
    if (is_replaced_) return std::nullopt;
    return tile;
  } catch (const semantic_map::store::MapStoreError&) {
    if (!is_checked_) throw;
    return std::nullopt;
  }
}

void LocalizerNode::connect(Subscriber& bus) {
  bus.subscribe<lidar_points_t>("LIDAR_POINTS", [this](const lidar_points_t& m) { on(m); }, {1500});
  bus.subscribe<odometry_t>("ODOMETRY", [this](const odometry_t& m) { on(m); }, {800});
}

void LocalizerNode::on(const lidar_points_t& message) {
  if (message.utime > 0 && !lidar_.accept(message.utime, message.packet)) return counters_.add("refused.second_lidar");
  clock_.add(message, odometry_.newest(), [this](const lidar_points_t& in_time) { queue(assembler_.add(in_time)); });
  if (message.utime <= 0) return;
  lidar_time_ = clock_.corrected(message.utime);
  process_due();
}

void LocalizerNode::on(const odometry_t& message) {
  // The error of odometry is configured: the filter's own covariance is not needed.
  const auto& known = message.pose_covariance;
  if (!std::all_of(std::begin(known), std::end(known), [](float v) { return std::isfinite(v); }))
    counters_.add("odometry.no_covariance");
  if (mapper::scan::take_odometry(message, odometry_, counters_)) process_due();
}

void LocalizerNode::queue(std::optional<mapper::scan::Scan> scan) {
  if (!scan) return;
  if (pending_.size() >= kMaxPending) {
    counters_.add("dropped.pending");
    pending_.pop_front();
  }
  pending_.push_back(std::move(*scan));
}

void LocalizerNode::process_due() {
  const auto due = [&](const mapper::scan::Scan& scan) {
    return odometry_.reaches(scan.end) || std::abs(lidar_time_ - scan.end) > microseconds(config_.odometry_wait_s);
  };
  while (!pending_.empty() && due(pending_.front())) process_next();
}

void LocalizerNode::process_next() {
  process(pending_.front());
  pending_.pop_front();
}

void LocalizerNode::process(const mapper::scan::Scan& scan) {
  odometry_.set_horizon(scan.end);
  const bool covered = odometry_.covers(scan.start, scan.end);
  if (!begun_ && !covered) {
    counters_.add("skipped.no_odometry_yet");
    return;
  }
  const std::int64_t begun = steady_clock();
  if (!begun_) begin(scan);
  const tracking::Motion motion = motion_to(scan);
  const double sweep_seconds = std::max(mapper::scan::seconds(scan.start, scan.end), 0.001);
  const mapper::scan::SweepMotion sweep = covered ? mapper::scan::sweep_from(odometry_, scan.start, scan.end)
                                                  : mapper::scan::steady_sweep(twist_, sweep_seconds);
  const auto deskewed = mapper::scan::deskew(scan.points, config_.vehicle.T_base_lidar(), sweep);
  tracking::ThinnedScan thinned{thinner_.thin(deskewed)};
  if (covered && !map_->paint().empty()) thinned.paint = paint_.find(deskewed, odometry_.at(scan.end));
  const tracking::PoseFit fit = tracker_ ? tracker_->track(thinned, motion, *map_) : tracking::PoseFit{};
  slides_ = fit.fits_but_slides(config_.tracking.min_match);
  if (!lost() || !covered || !motion.with_odometry)
    global_localizer_.restart();
  else
    search_globally(scan, thinned.points, motion);
  latency_.add(static_cast<double>(steady_clock() - begun) * 1e-6);
  last_end_ = scan.end;
  odometry_.forget_before(scan.start - 100'000);
  counters_.add("revolutions");
  if (lost()) counters_.add("revolutions.lost");
  publish(scan, answer(fit), motion.with_odometry);
}

/// Searches the whole map. A pose found this way must fit like any start before it is trusted.
void LocalizerNode::search_globally(const mapper::scan::Scan& scan, const std::vector<Eigen::Vector3d>& points,
                                    const tracking::Motion& motion) {
  const auto found = global_localizer_.process(points, odometry_.at(scan.end), motion, *map_);
  if (!found) return;
  counters_.add("found_in_whole_map");
  tracker_ = tracker_from(*found);
  global_localizer_.restart();
}

/// Starts at the configured pose, if there is one, on the map's ground, with roll and pitch from odometry.
void LocalizerNode::begin(const mapper::scan::Scan& scan) {
  begun_ = true;
  last_end_ = scan.end;
  if (config_.start.empty()) return;
  tracking::PoseBelief start;
  start.T_map_base = tracking::pose_on_ground(config_.start[0], config_.start[1], config_.start[2],
                                              odometry_.at(scan.end).linear(), *map_);
  tracking::Vector6 sigma;
  sigma << config_.start_sigma, config_.start_sigma, kStartHeight, kStartTilt, kStartTilt, config_.start_yaw_sigma;
  start.covariance = sigma.cwiseAbs2().asDiagonal();
  tracker_ = tracker_from(start);
}

std::unique_ptr<tracking::PoseTracker> LocalizerNode::tracker_from(const tracking::PoseBelief& start) const {
  if (config_.method == Method::kMonteCarlo)
    return std::make_unique<monte_carlo::ParticleFilter>(start, config_.monte_carlo, config_.tracking);
  return std::make_unique<tracking::Tracker>(start, config_.tracking);
}

/// The motion from end to end by odometry where it covers the interval; otherwise the previous motion continues for a
/// short time.
tracking::Motion LocalizerNode::motion_to(const mapper::scan::Scan& scan) {
  tracking::Motion motion;
  motion.seconds = mapper::scan::seconds(last_end_, scan.end);
  if (motion.seconds == 0) return motion;
  if (motion.seconds > 0 && odometry_.covers(last_end_, scan.end)) {
    motion.T_last_base = odometry_.at(last_end_).inverse() * odometry_.at(scan.end);
    const double stride = std::max(motion.seconds, 0.02);
    if (motion.T_last_base.translation().norm() <= kMaxSpeed * stride &&
        angle_of(motion.T_last_base) <= kMaxTurn * stride) {
      twist_ = mapper::scan::twist_of(motion.T_last_base, motion.seconds);
      bridge_.follow(odometry_.at(scan.end), twist_, motion.seconds);
      return motion;
    }
    counters_.add("odometry.incredible");
  } else if (const auto over_step = motion_over_clock_step(scan)) {
    counters_.add("revolutions.over_clock_step");
    motion.T_last_base = *over_step;
    motion.seconds = bridge_.stride();
    twist_ = bridge_.twist();
    return motion;
  }
  bridge_.coast(motion.seconds);
  counters_.add("revolutions.without_odometry");
  if (std::abs(motion.seconds) > kSteadyFor) counters_.add("gaps");
  motion.with_odometry = false;
  motion.T_last_base = mapper::scan::move(twist_, std::clamp(motion.seconds, 0.0, kSteadyFor));
  motion.seconds = std::abs(motion.seconds);
  twist_ = {};
  return motion;
}

/// Before its first sample after the step, odometry is where its motion came from.
std::optional<Pose> LocalizerNode::motion_over_clock_step(const mapper::scan::Scan& scan) {
  const bool is_there = odometry_.covers(scan.end, scan.end);
  const mapper::scan::OdometrySample* next = is_there ? nullptr : odometry_.soon_after(scan.end);
  if (!is_there && next == nullptr) return std::nullopt;
  const Pose T_odom_end = is_there ? odometry_.at(scan.end)
                                   : bridge_.before(next->T_odom_base, mapper::scan::seconds(scan.end, next->utime));
  const std::optional<Pose> motion = bridge_.motion_to(T_odom_end, mapper::scan::seconds(last_end_, scan.end));
  if (motion) bridge_.follow(T_odom_end, bridge_.twist(), bridge_.stride());
  return motion;
}

/// The tracked pose; without a tracker, the best hypothesis.
LocalizerNode::Answer LocalizerNode::answer(const tracking::PoseFit& fit) const {
  if (tracker_) return {tracker_->belief().T_map_base, tracker_->published_covariance(), fit};
  Answer guess;
  guess.covariance = kUnknown * kUnknown * tracking::Matrix6::Identity();
  if (const search::Hypothesis* best = global_localizer_.best()) {
    guess.T_map_base = best->belief.T_map_base;
    guess.fit = best->fit;
  }
  return guess;
}

void LocalizerNode::publish(const mapper::scan::Scan& scan, const Answer& answer, bool with_odometry) {
  map_pose_t message{};
  message.utime = scan.end;
  message.revolution = scan.number;
  message.epoch = epoch_;
  const auto& [T_map_base, covariance, fit] = answer;
  const bool known = odometry_.covers(scan.end, scan.end);
  const Pose T_map_odom = known ? normalised(T_map_base * odometry_.at(scan.end).inverse()) : Pose::Identity();
  pose_to_arrays(T_map_odom, message.map_odom_position, message.map_odom_orientation);
  pose_to_arrays(T_map_base, message.map_base_position, message.map_base_orientation);
  for (int i = 0; i < 36; ++i) message.covariance[i] = static_cast<float>(covariance(i / 6, i % 6));
  message.residual = static_cast<float>(fit.residual);
  message.inlier_ratio = static_cast<float>(lost() ? fit.matched_share() : fit.held_share());
  message.iterations = fit.iterations;
  message.degenerate = fit.degenerate;
  message.flags = (lost() ? map_pose_t::LOST : 0) | (lost() ? 0 : map_pose_t::REGISTERED) |
                  (lost() && global_localizer_.ambiguous() ? map_pose_t::AMBIGUOUS : 0) |
                  (with_odometry && known ? 0 : map_pose_t::NO_ODOMETRY) |
                  (known && odometry_.stationary(scan.start, scan.end) ? map_pose_t::STATIONARY : 0);
  bus_.publish("LOCALIZED_POSE", message);
}

void LocalizerNode::finish() {
  clock_.release([this](const lidar_points_t& held) { queue(assembler_.add(held)); });
  queue(assembler_.flush());
  while (!pending_.empty()) process_next();
}

NodeReport LocalizerNode::report() const {
  NodeReport report;
  report.counters = counters_;
  for (const Counters* part : {&clock_.counters(), &assembler_.counters()}) report.counters.add(*part);
  if (map_->unreadable() > 0)
    report.counters.add("map.unreadable_tiles", static_cast<std::int64_t>(map_->unreadable()));
  report.latency_p50 = latency_.percentile(0.5);
  report.latency_p99 = latency_.percentile(0.99);
  if (lidar_time_ == 0) report.faults.emplace_back("no LIDAR_POINTS");
  if (lidar_.two_send())
    report.faults.emplace_back(
        "two LiDARs send on LIDAR_POINTS, and one is used: give the other a `channel` of its own, or "
        "end the log that is played into the bus");
  clock_.add_faults(report.faults);
  mapper::scan::add_second_filter_fault(odometry_, report.faults);
  if (lidar_time_ != 0 && !begun_) report.faults.emplace_back("no usable ODOMETRY yet");
  if (is_replaced_)
    report.faults.push_back(
        fmt::format("{}: another drive has begun in this file, and only what was read of it before is used: "
                    "localizer.map must not be the file that semantic_map writes",
                    config_.map));
  if (tracker_ && lost()) {
    report.faults.push_back(slides_ ? fmt::format("lost along the street: {} shows only what looks the same everywhere "
                                                  "there; drive on",
                                                  config_.map)
                                    : fmt::format("lost: {} does not show what is seen here", config_.map));
  }
  if (begun_ && !tracker_) report.faults.push_back(fmt::format("not found yet in {}", config_.map));
  if (lost() && global_localizer_.ambiguous())
    report.faults.push_back(fmt::format("several places of {} look like this one", config_.map));
  return report;
}

}  // namespace curbstone::localizer
