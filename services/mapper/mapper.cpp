#include "services/mapper/mapper.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace curbstone::mapper {
namespace {

using Insertion = dense_map::DenseWork::Insertion;

constexpr int kScansToSolve = 10;                    // between a loop that is found and the map that moves
constexpr std::int64_t kMaxRemovals = 400'000;       // removal records, from which on the tiles are written anew
constexpr double kStandsStill = 0.5;                 // s without motion, after which a vehicle without odometry stands
constexpr std::int64_t kSearchPeriod = 500'000;      // us between two searches for a lost vehicle,
constexpr std::int64_t kSearchAnywhere = 2'000'000;  // and of the whole map, which takes most of a second

}  // namespace

Mapper::Mapper(const config::MapperConfig& config, const std::shared_ptr<SpillFile>& spill_file)
    : config_(config),
      co_moving_(config.vehicle),
      tracker_(config.tracker, config.registration, config.vehicle, config.mode != config::MapMode::kLocalise),
      atlas_(config.atlas, spill_file),
      local_map_(atlas_, tracker_),
      closer_(config.loop),
      solving_(config.threads > 1),
      relocalizer_(config.registration.icp, config.vehicle.T_base_lidar().translation()),
      dense_(std::make_unique<dense_map::DenseWorker>(config.dense, config.vehicle.T_base_lidar(), config.threads > 1,
                                                      spill_file)),
      start_(config.dense, config.vehicle.T_base_lidar(), config.threads > 1, spill_file) {}

std::optional<MapperUpdate> Mapper::process(const scan::Scan& revolution, const scan::OdometryHistory& odometry) {
  const std::optional<scan::Scan> rest = co_moving_.without(revolution, odometry);
  const scan::Scan& scan = rest ? *rest : revolution;
  if (resumed_pose_) resume_at(*resumed_pose_, scan, odometry);
  const std::optional<tracking::Tracked> tracked = tracker_.track(scan, odometry);
  if (!tracked) return std::nullopt;
  if (std::exchange(resumed_pose_, std::nullopt)) counters_.add(tracked->began ? "resumed.lost" : "resumed");
  resumed_map_.reset();
  if (tracked->began) standstill_ = Standstill::at(tracked->utime, tracked->T_map_base);

  const std::optional<Pose> T_odom_base = trusted_odometry(odometry, scan.end);
  const bool is_sought = must_search(*tracked);
  const auto relocalised = is_sought ? relocalise(*tracked, T_odom_base) : std::nullopt;
  const auto mapped = tracked->maps ? std::optional(map(*tracked)) : std::nullopt;

  MapperUpdate update = update_of(scan, *tracked, relocalised, mapped);
  if (odometry.covers(scan.end, scan.end))
    T_map_odom_ = normalised(update.T_map_base * odometry.at(scan.end).inverse());
  update.T_map_odom = T_map_odom_;
  if (update.fix == tracking::Fix::kTracking) {
    if (const int node = atlas_.reference(); node != pose_graph::Atlas::kNone)
      trajectory_.add({scan.end, scan.number, update.T_map_base, node, T_odom_base}, atlas_);
    end_search();
  }
  if (is_sought && !relocalised) {
    note_failed_search(scan.end, T_odom_base);
    update.wants_new_drive = failed_search_.is_hopeless();
  }
  return update;
}

/// T_odom_base at `utime`, unless odometry is missing or the tracker rejects it.
std::optional<Pose> Mapper::trusted_odometry(const scan::OdometryHistory& odometry, std::int64_t utime) const {
  if (!odometry.covers(utime, utime) || tracker_.odometry_check().rejects_odometry()) return std::nullopt;
  return odometry.at(utime);
}

/// Whether a lost vehicle is searched for with this scan. Not while registration follows something beside the vehicle,
/// which looks the same everywhere, nor with a LiDAR that shakes.
bool Mapper::must_search(const tracking::Tracked& tracked) const {
  return tracked.fix == tracking::Fix::kLost && !tracked.sparse && !tracker_.turn_refused() &&
         !tracker_.mount().shakes();
}

/// The result of a scan, without T_map_odom and wants_new_drive.
MapperUpdate Mapper::update_of(const scan::Scan& scan, const tracking::Tracked& tracked,
                               const std::optional<Relocalisation>& relocalised,
                               const std::optional<Mapped>& mapped) const {
  MapperUpdate update;
  update.utime = scan.end;
  update.revolution = scan.number;
  update.T_map_base = relocalised ? relocalised->T_map_base : mapped ? mapped->T_map_base : tracked.T_map_base;
  update.T_map_base_by_scan = tracked.T_map_base_by_scan;
  update.registration = tracked.registration;
  if (relocalised) update.registration.covariance = relocalised->covariance;
  update.fix = relocalised ? tracking::Fix::kTentative : tracked.fix;
  update.registered = tracked.registered || relocalised;
  update.with_odometry = tracked.with_odometry;
  update.stationary = tracked.stationary || (mapped && mapped->stands);
  update.standing_since = standstill_.began;
  update.has_moved = standstill_.has_moved;
  update.rearranged = (relocalised && relocalised->rolled_back) || (mapped && mapped->rearranged);
  update.start_is_over = mapped && mapped->start_is_over;
  update.points = tracked.points;
  return update;
}

/// Searches for the pose of a scan while the vehicle is lost.
std::optional<Mapper::Relocalisation> Mapper::relocalise(const tracking::Tracked& tracked,
                                                         const std::optional<Pose>& T_odom_base) {
  const std::int64_t period =
      pose_graph::Relocalizer::needs_global_search(tracker_.uncertainty()) ? kSearchAnywhere : kSearchPeriod;
  if (atlas_.size() == 0 || std::abs(tracked.utime - searched_) < period) return std::nullopt;
  searched_ = tracked.utime;
  counters_.add("searches");
  const auto found = relocalizer_.find(atlas_, *tracked.points, tracked.T_map_base, tracker_.uncertainty());
  if (!found) return std::nullopt;
  counters_.add("searches.found");
  earlier_.reset();
  solving_.cancel();
  const bool rolled_back = roll_back_to_agreement(found->T_map_base, tracked.utime, T_odom_base);
  const bool is_there = found->node < atlas_.size();
  const int nearest = is_there ? found->node : atlas_.nearest(found->T_map_base.translation());
  local_map_.rebuild(found->T_map_base, nearest != pose_graph::Atlas::kNone ? nearest : atlas_.size() - 1);
  tracker_.relocate(found->T_map_base);
  return Relocalisation{found->T_map_base, found->covariance, rolled_back};
}

/// Counts the search for a lost vehicle, part of whose motion was not measured. Pending points go into the map once no
/// scan is likely to settle them; not while the map moves, which must not take more than its share of a scan. A loaded
/// map is never given up, as the vehicle is meant to be found in it.
void Mapper::note_failed_search(std::int64_t utime, const std::optional<Pose>& T_odom_base) {
  if (!tracker_.was_unobserved() || config_.mode != config::MapMode::kMap) return;
  std::optional<Eigen::Vector3d> in_odom;
  if (T_odom_base) in_odom = T_odom_base->translation();
  failed_search_.add(utime, in_odom);
  if (failed_search_.seconds() < LostTimer::kMapper * 1e-6 || is_settled_ || dense_->is_moving()) return;
  is_settled_ = true;
  settled_ = dense_->finish();
}

/// If odometry was there all along and contradicts the way from the last mapped pose to `T_map_base`, but agrees with
/// the way from an earlier pose, everything mapped in between is wrong and is removed.
bool Mapper::roll_back_to_agreement(const Pose& T_map_base, std::int64_t utime,
                                    const std::optional<Pose>& T_odom_base) {
  if (!T_odom_base) return false;
  const auto good_until = trajectory_.last_agreement(T_map_base, utime, *T_odom_base, atlas_);
  if (!good_until) return false;
  counters_.add("rolled_back");
  atlas_.roll_back(*good_until);
  dense_->roll_back(*good_until);
  start_.end();
  trajectory_.roll_back(*good_until);
  relocalizer_.clear();
  return true;
}

/// Adds a scan that fits to the drive and to the map.
Mapper::Mapped Mapper::map(const tracking::Tracked& tracked) {
  standstill_ = standstill_.after(tracked.utime, tracked.T_map_base);
  const bool stands = !tracked.with_odometry && scan::seconds(standstill_.since, tracked.utime) > kStandsStill;
  if (config_.mode == config::MapMode::kLocalise) {
    atlas_.follow(tracked.T_map_base);
    local_map_.follow(tracked.T_map_base.translation());
    return {tracked.T_map_base, stands, false};
  }
  std::vector<Insertion> earlier;
  if (const auto& first = tracked.first) {
    const int anchor = atlas_.visit(first->utime, first->T_map_base, *first->points);
    earlier.push_back({first->points, first->T_map_base, first->utime, anchor, true});
  }
  if (tracked.map_restarted) {
    local_map_.leave();
    solving_.cancel();
  }
  const int anchor = atlas_.visit(tracked.utime, tracked.T_map_base, *tracked.points);
  const std::optional<Pose> correction = close_loop(tracked);
  const Pose T_map_base = correction ? normalised(*correction * tracked.T_map_base) : tracked.T_map_base;
  local_map_.follow(T_map_base.translation());
  const bool began_anew = drop_removals();
  grow(tracked, T_map_base, anchor, std::move(earlier));
  const bool start_is_over = dense_began_ != 0 && start_.end_if_replaced(dense_began_, tracked.utime);
  return {T_map_base, stands, correction.has_value() || began_anew, start_is_over};
}

/// Closes a loop if the vehicle is back at an earlier place. The loop is solved beside the next scans, and then
/// corrects the drive. Returns the correction of the vehicle's pose, T_new_old; nothing if nothing moves. Does not
/// search while the map still moves by an earlier loop.
std::optional<Pose> Mapper::close_loop(const tracking::Tracked& tracked) {
  if (solving_.is_under_way()) {
    std::optional<local_map::SolvedLoop> solved = solving_.next_scan();
    return solved ? correct_drive(std::move(*solved), tracked.T_map_base) : std::nullopt;
  }
  dense_->wait_inserted();
  if (dense_->is_moving()) return std::nullopt;
  const auto closure = closer_.search(atlas_, relocalizer_, *tracked.points, tracked.T_map_base);
  if (!closure) return std::nullopt;
  solving_.begin(kScansToSolve, [atlas = atlas_, closer = closer_, closure = *closure, at = tracked.T_map_base,
                                 empty = tracker_.empty_map()]() mutable {
    return local_map::solve_loop(std::move(atlas), closer, closure, at, std::move(empty));
  });
  return std::nullopt;
}

/// Corrects the whole drive, and the map with it. Keyframes made since the loop was found move with the one that the
/// vehicle was at then.
std::optional<Pose> Mapper::correct_drive(local_map::SolvedLoop solved, const Pose& T_map_base) {
  closer_.note_solved(solved.correction);
  if (!solved.correction) return std::nullopt;
  const pose_graph::PoseEdge& loop = solved.correction->loop;
  atlas_.add_loop(loop);
  if (!solved.local_map) return std::nullopt;
  std::vector<Pose>& T_new_old = solved.correction->T_new_old;
  T_new_old.resize(static_cast<std::size_t>(atlas_.size()), Pose(T_new_old[static_cast<std::size_t>(loop.to)]));
  const Pose here = T_new_old[static_cast<std::size_t>(atlas_.reference())];
  atlas_.move(T_new_old);
  dense_->move(T_new_old);
  start_.end();
  earlier_.reset();
  standstill_ = standstill_.corrected(here);
  local_map_.replace(std::move(*solved.local_map), normalised(here * T_map_base), atlas_.reference());
  return here;
}

bool Mapper::close_last_loop() {
  std::optional<local_map::SolvedLoop> solved = solving_.take();
  return solved && correct_drive(std::move(*solved), tracker_.T_map_base());
}

/// Rewrites the tiles without removal records once there are too many of these. True if it did.
bool Mapper::drop_removals() {
  dense_->wait_inserted();
  if (solving_.is_under_way() || dense_->is_moving() || dense_->num_removals() < kMaxRemovals) return false;
  dense_->move({});
  return true;
}

/// Inserts the scan into the dense map, in parallel to waiting for the next scan and registering it. The first
/// standstill has a map of its own, except in a loaded map, where registration gives the tilt.
void Mapper::grow(const tracking::Tracked& tracked, const Pose& T_map_base, int anchor,
                  std::vector<Insertion> earlier) {
  if (config_.dense.ring_scale) scale_.learn(*tracked.points, T_map_base);
  const bool at_start = config_.mode == config::MapMode::kMap && start_.takes(standstill_, tracked.utime);
  if (!at_start && !standstill_.has_moved) stay_at_start();
  const std::int64_t began = at_start ? start_.began() : dense_began_;
  if (began == 0) earlier_.reset();
  const std::int64_t stands_since = began == 0 ? tracked.utime : std::max(standstill_.since, began);
  const bool add_new = scan::seconds(stands_since, tracked.utime) < config_.dense.standing_s;

  dense_map::DenseWork work{std::move(earlier), std::nullopt};
  work.insertions.push_back({tracked.points, T_map_base, tracked.utime, anchor, add_new});
  work.removal = removal_after(std::exchange(earlier_, Earlier{T_map_base, tracked.utime}), T_map_base, tracked.utime);
  if (config_.dense.ring_scale) {
    for (Insertion& insertion : work.insertions) insertion.scale = scale_.table();
  }
  if (at_start) {
    start_.map().begin(std::move(work));
    start_.note_scan(tracked.utime);
  } else {
    dense_->begin(std::move(work));
    if (dense_began_ == 0) dense_began_ = tracked.utime;
  }
}

/// Makes the map of the first standstill the drive's own: the vehicle has not moved, so there is no other map.
void Mapper::stay_at_start() {
  const std::int64_t began = start_.began();
  std::unique_ptr<dense_map::DenseWorker> map = start_.hand_over();
  if (!map) return;
  map->wait_inserted();
  map->note_all_changed();
  dense_ = std::move(map);
  dense_began_ = began;
}

/// Prepares free-space removal. Only points whose keyframe is in the local map can be judged.
std::optional<dense_map::DenseWork::FreeSpaceRemoval> Mapper::removal_after(const std::optional<Earlier>& earlier,
                                                                            const Pose& T_map_base,
                                                                            std::int64_t utime) const {
  if (!earlier) return std::nullopt;
  const double dt = scan::seconds(earlier->utime, utime);
  if (!(dt > 0 && dt < kMaxScanInterval)) return std::nullopt;
  dense_map::DenseWork::FreeSpaceRemoval removal;
  removal.motion = scan::twist_of(earlier->T_map_base.inverse() * T_map_base, dt);
  removal.present.reserve(static_cast<std::size_t>(atlas_.size()));
  for (int id = 0; id < atlas_.size(); ++id) removal.present.push_back(atlas_.present(id));
  const auto end_of_known = removal.present.begin() + atlas_.num_known();
  removal.on_known_map = std::find(removal.present.begin(), end_of_known, true) != end_of_known;
  return removal;
}

std::vector<TileKey> Mapper::take_changed() {
  std::vector<TileKey> changed = dense_->take_changed();
  for (const TileKey& key : std::exchange(settled_, {})) changed.push_back(key);
  return changed;
}

void Mapper::begin_free_space_removal() {
  if (start_.is_there()) start_.map().begin_free_space_removal();
  dense_->begin_free_space_removal();
}

void Mapper::wait_inserted() {
  if (start_.is_there()) start_.map().wait_inserted();
  dense_->wait_inserted();
}

void Mapper::wait() {
  if (start_.is_there()) start_.map().wait();
  dense_->wait();
}

bool Mapper::show_drive() {
  if (!standstill_.has_moved) stay_at_start();
  const bool was_another = start_.is_shown();
  start_.end();
  return was_another;
}

std::vector<TileKey> Mapper::finish() {
  (void)show_drive();
  std::vector<TileKey> changed = dense_->finish();
  for (const TileKey& key : dense_->take_changed()) changed.push_back(key);
  return changed;
}

Counters Mapper::counters() const {
  Counters all = counters_;
  for (const Counters* part :
       {&tracker_.counters(), &tracker_.odometry_check().counters(), &tracker_.mount().counters(), &closer_.counters(),
        &scale_.counters(), &dense_->counters(), &co_moving_.counters()})
    all.add(*part);
  return all;
}

}  // namespace curbstone::mapper
