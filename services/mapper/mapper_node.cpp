#include "services/mapper/mapper_node.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <curbstone/map_pose_t.hpp>
#include <utility>

#include "common/bus/levels.hpp"
#include "common/resend/message_keeper.hpp"
#include "common/time/clock.hpp"
#include "common/time/has_passed.hpp"

namespace curbstone::mapper {
namespace {

constexpr int kMaxScansPerTick = 5;               // scans processed per call
constexpr std::int64_t kIndexPeriod = 1'000'000;  // us
constexpr std::int64_t kRearranging = 100'000;    // us, unless the next scan comes before
constexpr int kRefusedInARow = 10;                // scans that do not fit the map: from here on a fault
constexpr std::int64_t kGyroWindow = 100'000;     // us before the end of a scan in which a gyro must have measured

std::vector<TrajectoryPoint> points_of(const std::vector<journal::RecordedPose>& drive) {
  std::vector<TrajectoryPoint> points;
  points.reserve(drive.size());
  for (const journal::RecordedPose& pose : drive)
    points.push_back({pose.utime, pose.revolution, pose.T_map_base, pose.node});
  return points;
}

}  // namespace

MapperNode::MapperNode(const config::MapperConfig& config, Publisher& bus)
    : config_(config),
      bus_(bus),
      input_(bus, "mapper", {config.start_wait_s, config.odometry_wait_s}),
      spill_file_(make_spill_file(config)),
      mapper_(std::in_place, config, spill_file_),
      sensor_monitor_(config.vehicle),
      lidar_at_start_(config.vehicle),
      sender_(bus) {
  if (!config_.folder.empty() && config_.mode != config::MapMode::kLocalise)
    saver_.emplace(config_.folder, config_.save_every);
  if (resume_drive()) return;
  if (config_.mode != config::MapMode::kMap)
    begin_map();
  else
    lidar_at_start_.begin();
}

void MapperNode::connect(Subscriber& bus) {
  // 750 packets per second: two seconds of packets may wait while a scan is registered.
  bus.subscribe<lidar_points_t>("LIDAR_POINTS", [this](const lidar_points_t& m) { on(m); }, {1500});
  bus.subscribe<lidar_points_t>(resent_channel("LIDAR_POINTS"), [this](const lidar_points_t& m) { on_resent(m); },
                                {3000});
  bus.subscribe<odometry_t>("ODOMETRY", [this](const odometry_t& m) { on(m); }, {800});
  bus.subscribe<odometry_t>(resent_channel("ODOMETRY"), [this](const odometry_t& m) { on_resent(m); }, {3000});
  bus.subscribe<tile_request_t>("TILE_REQUEST", [this](const tile_request_t& m) { on(m); }, {100});
}

void MapperNode::on(const lidar_points_t& message) {
  sensor_monitor_.heard();
  input_.add(message);
  process_due();
}

void MapperNode::on_resent(const lidar_points_t& message) {
  input_.add_resent(message);
  process_due();
}

void MapperNode::on(const odometry_t& message) {
  if (input_.add(message)) process_due();
}

void MapperNode::on_resent(const odometry_t& message) {
  input_.add_resent(message);
  process_due();
}

void MapperNode::on(const tile_request_t& message) {
  sender_.request(message);
}

/// Processes the scans that are due. If many are due at once (packets behind a gap, late odometry), not all in one
/// call: meanwhile the process could neither publish nor request missing messages. For scans whose odometry is there
/// the delay does not change the result.
void MapperNode::process_due() {
  for (int done = 0; !input_.empty() && input_.is_due(mapper_->started()); ++done) {
    if (done >= kMaxScansPerTick && input_.has_odometry()) return;
    process(input_.pop());
  }
}

void MapperNode::process(scan::Scan scan) {
  if (mapper_->is_new_drive() && input_.is_filter_starting(scan)) {
    counters_.add("skipped.odometry_not_ready");  // a map begun now would not be level
    return;
  }
  if (resumed_from_ != 0) note_missing(scan);
  const std::int64_t begin = steady_clock();
  sensor_monitor_.clean(scan);
  const std::optional<MapperUpdate> update = mapper_->process(scan, input_.odometry());
  latency_.add(static_cast<double>(steady_clock() - begin) * 1e-6);
  input_.forget_before(scan.start);
  if (!update) return;
  last_end_ = scan.end;
  input_.note_processed(scan.end, update->with_odometry);
  position_ = update->T_map_base.translation();
  monitor_sensors(*update);
  if (update->rearranged) start_drive_.clear();
  const bool begins = epoch_ == 0 || update->rearranged || update->start_is_over;
  if (begins) name_epoch(update->utime);
  publish_pose(*update);
  if (begins) begin_epoch(update->utime, update->rearranged);
  keep_pose(*update);
  rearranged_at_ = update->rearranged ? update->utime : 0;
  has_unsent_ = true;
  is_pause_ = false;
  if (update->wants_new_drive)
    begin_new_drive("the vehicle was lost and is not to be found in what this drive had mapped");
  else
    check_lidar(*update);
}

/// While odometry coasts on the wheels, and while its filter has just been started, its turn is not compared with the
/// LiDAR's.
void MapperNode::monitor_sensors(const MapperUpdate& update) {
  odometry_restart_.add(update.utime, input_.odometry().longest_step(update.utime - kGyroWindow));
  const bool is_measure = update.with_odometry && !odometry_restart_.is_recent() &&
                          input_.odometry().with_gyro(update.utime - kGyroWindow, update.utime);
  const std::optional<Pose> T_odom_base =
      is_measure ? std::optional(update.T_map_odom.inverse() * update.T_map_base) : std::nullopt;
  const std::optional<Pose>& by_scan = update.T_map_base_by_scan;
  // Registered, but not by the tracker: the vehicle was lost and has been relocalised.
  const bool goes_on = !update.rearranged && (by_scan || !update.registered);
  if (!goes_on) sensor_monitor_.begin_map();
  if (goes_on && by_scan && T_odom_base) sensor_monitor_.compare(update.utime, *by_scan, *T_odom_base);
  if (update.rearranged || !update.registered || update.fix != tracking::Fix::kTracking)
    return sensor_monitor_.interrupt();
  const bool is_fully_constrained = (update.registration.degenerate & registration::kPlanarAxes) == 0;
  sensor_monitor_.add({update.utime, update.points.get(), update.T_map_base, T_odom_base, is_fully_constrained});
}

/// Over the first metres of a new map: begins it again where the LiDAR is not mounted as vehicle.lidar says.
void MapperNode::check_lidar(const MapperUpdate& update) {
  const scan::OdometryHistory& odometry = input_.odometry();
  const bool has_gyro = update.with_odometry && odometry.with_gyro(update.utime - kGyroWindow, update.utime);
  const auto why = lidar_at_start_.add({update.utime, update.points.get(), update.T_map_base,
                                        has_gyro ? std::optional(odometry.at(update.utime)) : std::nullopt,
                                        sensor_monitor_.is_upside_down()});
  if (why) begin_with_other_lidar(*why);
}

void MapperNode::name_epoch(std::int64_t utime) {
  const auto now = static_cast<std::int32_t>(std::clamp<std::int64_t>(utime / 1'000'000, 1, 2'147'483'000));
  epoch_ = std::max({epoch_ + 1, epoch_before_ + 1, now});
  counters_.add("epochs");
}

/// Sends the map and the drive again, in the epoch that has its name. After a rearrangement the tiles follow as
/// changed ones, once they have moved.
void MapperNode::begin_epoch(std::int64_t utime, bool is_rearranged) {
  if (saver_) saver_->begin_epoch(epoch_);
  std::vector<journal::RecordedPose> drive = drive_so_far();
  std::erase_if(drive, [&](const auto& pose) { return pose.utime >= utime; });  // later poses follow as MAP_POSE
  sender_.start_epoch(epoch_, position_, points_of(drive));
  index_sent_ = 0;
  if (!is_rearranged) {
    mapper_->wait();
    sender_.queue_tiles(mapper_->shown().keys());
  }
  journal_epoch(drive, is_rearranged);
  if (mapper_->is_at_start()) start_drive_ = std::move(drive);
}

/// The poses of the drive so far. For the first standstill all poses: the mapper's own trajectory has only one every
/// few centimetres.
std::vector<journal::RecordedPose> MapperNode::drive_so_far() {
  if (!resumed_drive_.empty()) return std::exchange(resumed_drive_, {});
  if (!start_drive_.empty()) return std::exchange(start_drive_, {});
  return mapper_->recorded();
}

void MapperNode::publish_pose(const MapperUpdate& update) {
  map_pose_t message{};
  message.utime = update.utime;
  message.revolution = update.revolution;
  message.epoch = epoch_;
  pose_to_arrays(update.T_map_odom, message.map_odom_position, message.map_odom_orientation);
  pose_to_arrays(update.T_map_base, message.map_base_position, message.map_base_orientation);
  registration::Matrix6 to_map =
      registration::Matrix6::Identity();  // translation in map axes, rotation in base_link axes
  to_map.topLeftCorner<3, 3>() = update.T_map_base.linear();
  const registration::Matrix6 covariance = to_map * update.registration.covariance * to_map.transpose();
  for (int i = 0; i < 36; ++i) message.covariance[i] = static_cast<float>(covariance(i / 6, i % 6));
  message.residual = static_cast<float>(update.registration.residual);
  message.inlier_ratio = static_cast<float>(update.registration.inlier_ratio);
  message.iterations = update.registration.iterations;
  message.degenerate = update.registration.degenerate;
  message.flags = (update.registered ? map_pose_t::REGISTERED : 0) |
                  (update.with_odometry ? 0 : map_pose_t::NO_ODOMETRY) |
                  (update.stationary ? map_pose_t::STATIONARY : 0) |
                  (update.fix == tracking::Fix::kTracking ? 0 : map_pose_t::LOST);
  bus_.publish("MAP_POSE", message);
}

/// Records poses that are tracked.
void MapperNode::keep_pose(const MapperUpdate& update) {
  if (update.fix != tracking::Fix::kTracking) return;
  sender_.add_pose({update.utime, update.revolution, update.T_map_base});
  const int node = mapper_->atlas().reference();
  if (node == pose_graph::Atlas::kNone) return;
  const journal::RecordedPose pose{update.utime,          update.revolution, node,
                                   update.T_map_base,     update.T_map_odom, update.with_odometry,
                                   update.standing_since, update.has_moved};
  if (journal_) journal_->add(pose);
  if (mapper_->is_at_start())
    start_drive_.push_back(pose);
  else
    start_drive_.clear();
}

void MapperNode::take_changes(std::int64_t now) {
  mapper_->wait_inserted();
  const std::vector<TileKey> changed = mapper_->take_changed();
  const std::vector<TileKey> evicted = mapper_->take_evicted();
  sender_.queue_tiles(mapper_->shows_start() ? mapper_->take_changed_of_start() : changed);
  sender_.forget(evicted);
  if (!journal_) return;
  if (journal_->needs_restart(now)) journal_->start_epoch(epoch_, mapper_->recorded());
  journal_->set_rings(mapper_->rings());
  journal_->write(mapper_->grown(), mapper_->atlas(), changed, evicted, now);
  if (config_.mode != config::MapMode::kLocalise)  // else it is made of keyframes
    journal_->local_map().write(mapper_->registration_levels(), epoch_, last_end_, now);
}

void MapperNode::send_changes(std::int64_t now) {
  has_unsent_ = false;
  take_changes(now);
  if (index_sent_ == 0) send_index(now);  // before the tiles that it announces
  sender_.send_changes(mapper_->shown(), now);
}

void MapperNode::send_index(std::int64_t now) {
  sender_.send_index(now, position_);
  index_sent_ = now;
}

void MapperNode::send_due_index(std::int64_t now) {
  if (has_passed(kIndexPeriod, index_sent_, now)) send_index(now);
}

/// The map moves meanwhile, which takes longer than the insertion of a scan: nothing waits for it, so that the next
/// pose is not late.
bool MapperNode::is_rearranging(std::int64_t now) const {
  return rearranged_at_ != 0 && !has_passed(kRearranging, rearranged_at_, now);
}

void MapperNode::caught_up(std::int64_t now) {
  if (has_unsent_ && epoch_ != 0 && !is_rearranging(now)) send_changes(now);
}

void MapperNode::tick(std::int64_t now) {
  if (is_over_) return send_rest(now);
  sensor_monitor_.tick(now);
  input_.tick(now);
  process_due();
  if (epoch_ == 0) {
    if (journal_) journal_->wait(now);
    return;
  }
  sender_.send_trajectory();
  if (is_rearranging(now)) return;
  send_changes(now);
  sender_.send_requested(mapper_->shown());
  send_due_index(now);
  keep_map();
  if (std::exchange(is_pause_, true))
    mapper_->begin_free_space_removal();  // downstream services are done with the scan
}

NodeReport MapperNode::report() const {
  NodeReport report;
  add_counters(report.counters);
  add_disk_faults(report.faults);
  input_.add_packet_faults(report.faults);
  lidar_at_start_.add_faults(report.faults);
  sensor_monitor_.add_faults(report.faults);
  mapper_->add_faults(report.faults);
  input_.add_odometry_faults(report.faults, epoch_ != 0, last_end_);
  add_turn_faults(report.faults);
  add_fit_faults(report.faults);
  report.latency_p50 = latency_.percentile(0.5);
  report.latency_p99 = latency_.percentile(0.99);
  return report;
}

void MapperNode::add_counters(Counters& counters) const {
  counters.add(counters_);
  input_.add_counters(counters);
  counters.add(mapper_->counters());
  counters.add(lidar_at_start_.counters());
  sensor_monitor_.add_counters(counters);
  if (saver_) counters.add(saver_->counters());
  set_level(counters, "far.memory_kb", static_cast<std::int64_t>(spill_file_->bytes_in_memory() / 1024));
  set_level(counters, "far.disk_kb", static_cast<std::int64_t>(spill_file_->bytes_in_file() / 1024));
  set_level(counters, "far.unreadable", spill_file_->unreadable());
  counters.add("faults.far_tiles", spill_file_->failed_reads());
}

/// Faults of scans that were refused because they turn otherwise than wheels and gyro.
void MapperNode::add_turn_faults(std::vector<std::string>& faults) const {
  if (mapper_->turn_refused()) {
    faults.emplace_back(
        "LiDAR: it turns otherwise than wheels and gyro: does something large drive along beside it, or are its stamps "
        "late or early? Odometry alone is believed meanwhile");
    return;
  }
  const std::int64_t ago = last_end_ - mapper_->turn_refused_at();
  if (mapper_->turn_refused_at() == 0 || ago < 0 || ago >= kReportedFor) return;
  faults.push_back(
      fmt::format("LiDAR: it turned otherwise than wheels and gyro, {:.0f} s ago: did something large drive along "
                  "beside it, or are its stamps late or early? Where that was, the map has gaps or is bent",
                  static_cast<double>(ago) * 1e-6));
}

/// Faults of a vehicle that is lost, or of scans that do not fit the map.
void MapperNode::add_fit_faults(std::vector<std::string>& faults) const {
  if (epoch_ != 0 && mapper_->fix() != tracking::Fix::kTracking) {
    faults.emplace_back("lost: looking for where the vehicle is; nothing is mapped");
  } else if (mapper_->refused_in_a_row() >= kRefusedInARow) {
    faults.push_back(fmt::format("{} revolutions in a row do not fit the map", mapper_->refused_in_a_row()));
  }
}

}  // namespace curbstone::mapper
