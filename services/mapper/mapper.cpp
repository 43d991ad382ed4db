#include "services/mapper/mapper.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace curbstone {
namespace {

constexpr std::size_t kMostHeld = 20;                // revolutions of the first standstill: more show nothing new
constexpr std::int64_t kMostRemovals = 400'000;      // records of what has gone, until the tiles begin anew
constexpr double kLongestStep = 0.3;                 // s between revolutions that tell how the vehicle moved
constexpr std::int64_t kSearchPeriod = 500'000;      // us between two searches for where the vehicle is,
constexpr std::int64_t kSearchAnywhere = 2'000'000;  // and where it may be anywhere: that takes most of a second
constexpr double kContradiction = 0.5;               // m between two accounts of where the vehicle is, and
constexpr double kContradictionDrift = 0.05;         // more for each m of odometry, that only an error explains
constexpr float kFootprint = 0.03F;                  // m between footprints
constexpr std::int64_t kWitness = 30'000'000;        // us for which odometry can tell

}  // namespace

Mapper::Mapper(const MapperConfig& config)
    : config_(config),
      tracker_(config),
      atlas_(config.atlas),
      closer_(config.loop),
      finder_(config.icp, config.vehicle.T_base_lidar().translation()),
      dense_(config.dense, config.vehicle.T_base_lidar(), config.threads > 1) {}

void Mapper::load(const SavedMap& map) {
  for (const SavedTile& tile : map.tiles) dense_.map().load(tile.key, tile.z_origin, tile.utime, tile.points);
  for (const MapNode& node : map.nodes) atlas_.add_known(node);
  for (const PoseEdge& edge : map.edges) atlas_.add_known(edge);
  Pose T_map_start(Eigen::Translation3d(config_.start_x, config_.start_y, 0));
  T_map_start.rotate(Eigen::AngleAxisd(config_.start_yaw, Eigen::Vector3d::UnitZ()));
  const std::vector<int> near = atlas_.near(T_map_start.translation(), std::numeric_limits<double>::infinity());
  if (!near.empty()) T_map_start.translation().z() = atlas_.node(near.front()).T_map_base.translation().z();
  tracker_.begin_at(T_map_start, config_.start_radius);
}

MapSnapshot Mapper::snapshot(std::int32_t epoch, const MapVersions& on_disk) const {
  MapSnapshot out;
  out.map.voxel = config_.dense.voxel;
  out.map.epoch = out.versions.epoch = epoch;
  const bool comparable = on_disk.epoch == epoch;
  const DenseMap& dense = dense_.map();
  for (const TileKey& key : dense.keys()) {
    const DenseTile& tile = *dense.tile(key);
    if (tile.num_points() == 0) continue;
    const MapVersions::Tile version{tile.utime(), tile.removed_at(), tile.records().size()};
    const auto known = on_disk.tiles.find(key);
    const bool kept = comparable && known != on_disk.tiles.end() && known->second == version;
    out.map.tiles.push_back({key, tile.z_origin(), tile.utime(), {}, kept});
    if (!kept) out.map.tiles.back().points = tile.points();
    out.versions.tiles.emplace(key, version);
  }
  for (int id = 0; id < atlas_.size(); ++id) {
    const MapNode& node = atlas_.node(id);
    const auto index = static_cast<std::size_t>(id);
    out.versions.nodes.push_back({node.utime, node.T_map_base.matrix(), node.points.size()});
    const bool kept = comparable && out.map.nodes_on_disk == index && index < on_disk.nodes.size() &&
                      on_disk.nodes[index] == out.versions.nodes.back();
    if (kept) ++out.map.nodes_on_disk;
    out.map.nodes.push_back(kept ? MapNode{node.utime, node.T_map_base, {}} : node);
  }
  out.map.edges = atlas_.edges();
  out.versions.edges = out.map.edges.size();
  return out;
}

std::optional<MapperUpdate> Mapper::process(const Revolution& revolution, const OdometryHistory& odometry) {
  std::optional<Tracked> tracked = tracker_.track(revolution, odometry);
  if (!tracked) return std::nullopt;
  T_odom_base_ =
      odometry.covers(revolution.end, revolution.end) ? std::optional(odometry.at(revolution.end)) : std::nullopt;
  MapperUpdate update;
  update.utime = revolution.end;
  update.revolution = revolution.number;
  update.registration = tracked->registration;
  update.with_odometry = tracked->with_odometry;
  if (tracked->began) {
    moved_ = started_ = tracked->utime;
    T_map_moved_ = tracked->T_map_base;
    has_moved_ = false;
  }
  if (tracked->fix == Fix::kLost) search(*tracked, update);
  if (tracked->first) take_first(*tracked->first);
  if (tracked->maps) take(*tracked, update);
  if (T_odom_base_) T_map_odom_ = normalised(tracked->T_map_base * T_odom_base_->inverse());
  update.T_map_base = tracked->T_map_base;
  update.T_map_odom = T_map_odom_;
  update.fix = tracked->fix;
  update.registered = tracked->registered;
  update.stationary = tracked->stationary;
  leave_footprint(update);
  return update;
}

/// A revolution that fits: the drive goes on to here, and the map grows.
void Mapper::take(Tracked& tracked, MapperUpdate& update) {
  notice_motion(tracked);
  if (config_.mode == "localise") {
    atlas_.follow(tracked.T_map_base);
    recall_surroundings(tracked.T_map_base.translation());
    return;
  }
  if (tracked.anew) atlas_.leave();
  const int anchor = atlas_.visit(tracked.utime, tracked.T_map_base, tracked.points);
  close_loop(tracked, update);
  recall_surroundings(tracked.T_map_base.translation());
  grow(tracked, anchor, update);
}

/// The map for registration moves with the vehicle: far nodes leave it, those that come near return.
void Mapper::recall_surroundings(const Eigen::Vector3d& position) {
  if (tracker_.forget_far()) atlas_.forget_far(position, tracker_.window());
  for (const int id : atlas_.take_returning(position, tracker_.window())) tracker_.recall(atlas_.node(id));
}

void Mapper::take_first(const Tracked::Earlier& first) {
  const int anchor = atlas_.visit(first.utime, first.T_map_base, first.points);
  work_.insertions.push_back({first.points, first.T_map_base, first.utime, anchor, true});
}

void Mapper::notice_motion(Tracked& tracked) {
  const Pose since_moved = T_map_moved_.inverse() * tracked.T_map_base;
  if (since_moved.translation().norm() > 0.05 || angle_of(since_moved) > 0.01) {
    T_map_moved_ = tracked.T_map_base;
    moved_ = tracked.utime;
    if (!tracked.began) has_moved_ = true;
  }
  if (!tracked.with_odometry && seconds(moved_, tracked.utime) > 0.5) tracked.stationary = true;
}

/// What the revolution shows goes into the dense map, while the next one is waited for and registered.
void Mapper::grow(Tracked& tracked, int anchor, MapperUpdate& update) {
  if (dense_.num_removals() >= kMostRemovals) {
    dense_.map().move({});
    update.rearranged = true;
  }
  if (!holds_back(tracked, anchor)) {
    release_held();
    const bool add_new = seconds(moved_, tracked.utime) < config_.dense.standing_s;
    work_.look = look_through(tracked);
    work_.insertions.push_back({std::move(tracked.points), tracked.T_map_base, tracked.utime, anchor, add_new});
  }
  if (!work_.insertions.empty()) dense_.begin(std::exchange(work_, {}));
}

/// What has left is taken out. Only points that are where registration sees their surroundings can be judged.
std::optional<DenseWork::Look> Mapper::look_through(const Tracked& tracked) {
  const std::optional<Earlier> earlier = std::exchange(earlier_, Earlier{tracked.T_map_base, tracked.utime});
  if (!earlier || tracked.fix != Fix::kTracking) return std::nullopt;
  const double dt = seconds(earlier->utime, tracked.utime);
  if (!(dt > 0 && dt < kLongestStep)) return std::nullopt;
  DenseWork::Look look;
  look.motion = twist_of(earlier->T_map_base.inverse() * tracked.T_map_base, dt);
  for (int id = 0; id < atlas_.size(); ++id) look.present.push_back(atlas_.present(id));
  const auto end_of_known = look.present.begin() + atlas_.num_known();
  look.on_known_map = std::find(look.present.begin(), end_of_known, true) != end_of_known;
  return look;
}

/// Standing, sixteen beams draw the same sixteen rings again and again, and the filter does not know its tilt to better
/// than the accelerometer's bias: 0.2 degrees put a ring 19 m ahead 6 cm off the road as it is found to be on the way,
/// which is a curb to look at. So the first standstill waits, and is forgotten once the vehicle moves.
bool Mapper::holds_back(const Tracked& tracked, int anchor) {
  if (has_moved_) held_.clear();
  if (has_moved_ || seconds(started_, tracked.utime) > config_.dense.start_hold_s) return false;
  if (held_.size() < kMostHeld) held_.push_back({tracked.points, tracked.T_map_base, tracked.utime, anchor, true});
  return true;
}

void Mapper::release_held() {
  for (DenseWork::Insertion& held : std::exchange(held_, {})) work_.insertions.push_back(std::move(held));
}

std::vector<TileKey> Mapper::take_changed() {
  return dense_.take_changed();
}

std::vector<TileKey> Mapper::finish() {
  release_held();  // it never moved: then that is all there is
  if (!work_.insertions.empty()) dense_.begin(std::exchange(work_, {}));
  std::vector<TileKey> changed = dense_.map().finish();  // first what was begun, the last look too
  for (const TileKey& key : dense_.take_changed()) changed.push_back(key);
  return changed;
}

/// Back at a place of long ago: the whole drive is put right, and the map with it.
void Mapper::close_loop(Tracked& tracked, MapperUpdate& update) {
  const auto closure = closer_.look(atlas_, finder_, tracked.points, tracked.T_map_base);
  if (!closure) return;
  const auto corrections = closer_.solve(atlas_, *closure, tracked.T_map_base);
  if (!corrections || !closer_.matters(*corrections, atlas_)) return;
  std::vector<Pose> poses = atlas_.poses();
  for (std::size_t i = 0; i < poses.size(); ++i) poses[i] = normalised((*corrections)[i] * poses[i]);
  const Pose& here = (*corrections)[static_cast<std::size_t>(atlas_.reference())];
  atlas_.set_poses(poses);
  dense_.map().move(*corrections);
  earlier_.reset();
  tracked.T_map_base = normalised(here * tracked.T_map_base);
  T_map_moved_ = normalised(here * T_map_moved_);
  rebuild_registration(tracked.T_map_base, atlas_.reference());
  update.rearranged = true;
}

/// The surroundings as the nodes remember them, so far as the graph says that drift has not displaced them.
void Mapper::rebuild_registration(const Pose& T_map_base, int reference) {
  std::vector<int> ids;
  std::vector<const MapNode*> nodes;
  for (const int id : atlas_.connected(reference, config_.atlas.connected)) {
    const Eigen::Vector3d away = atlas_.node(id).T_map_base.translation() - T_map_base.translation();
    if (id != reference && away.cwiseAbs().maxCoeff() > tracker_.window()) continue;
    ids.push_back(id);
    nodes.push_back(&atlas_.node(id));
  }
  atlas_.set_present(ids, reference);
  tracker_.rebuild(nodes, T_map_base);
}

/// Lost: looks where this revolution may have been taken. If odometry held all along and says that the drive cannot
/// have come here from where it was last mapped, but from an earlier place it can, then what was mapped between is
/// wrong.
void Mapper::search(Tracked& tracked, MapperUpdate& update) {
  const std::int64_t period = PlaceFinder::is_anywhere(tracker_.doubt()) ? kSearchAnywhere : kSearchPeriod;
  if (atlas_.size() == 0 || std::abs(tracked.utime - searched_) < period) return;
  searched_ = tracked.utime;
  counters_.add("searches");
  const auto found = finder_.find(atlas_, tracked.points, tracked.T_map_base, tracker_.doubt());
  if (!found) return;
  counters_.add("searches.found");
  tracked.T_map_base = found->T_map_base;
  earlier_.reset();
  tracked.fix = Fix::kTentative;
  tracked.registered = true;
  tracked.registration.covariance = found->covariance;
  if (const auto good_until = contradiction(found->T_map_base, tracked.utime)) {
    counters_.add("rolled_back");
    atlas_.roll_back(*good_until);
    dense_.map().roll_back(*good_until);
    finder_.forget();
    std::erase_if(footprints_, [&](const Footprint& f) { return f.utime > *good_until; });
    witnesses_.clear();
    update.rearranged = true;
  }
  rebuild_registration(found->T_map_base, found->node < atlas_.size() ? found->node : nearest(found->T_map_base));
  tracker_.relocate(found->T_map_base);
}

int Mapper::nearest(const Pose& T_map_base) const {
  const std::vector<int> near = atlas_.near(T_map_base.translation(), std::numeric_limits<double>::infinity());
  return near.empty() ? atlas_.size() - 1 : near.front();
}

/// When the drive's own account and odometry's last agreed on how the vehicle came to be here; nothing if they agree
/// until the last, or never did.
std::optional<std::int64_t> Mapper::contradiction(const Pose& T_map_base, std::int64_t utime) const {
  if (!T_odom_base_) return std::nullopt;
  bool disagreed = false;
  for (auto it = witnesses_.rbegin(); it != witnesses_.rend() && utime - it->footprint.utime < kWitness; ++it) {
    const Pose moved = it->T_odom_base.inverse() * *T_odom_base_;
    const Pose expected = T_map_of(it->footprint) * moved;
    const double apart = (expected.translation() - T_map_base.translation()).norm();
    const bool agrees = apart < kContradiction + kContradictionDrift * moved.translation().norm();
    if (agrees) return disagreed ? std::optional(it->footprint.utime) : std::nullopt;
    disagreed = true;
  }
  return std::nullopt;
}

void Mapper::leave_footprint(const MapperUpdate& update) {
  if (atlas_.reference() == Atlas::kNone || update.fix != Fix::kTracking) return;
  const Pose T_node_base = atlas_.node(atlas_.reference()).T_map_base.inverse() * update.T_map_base;
  const Footprint footprint{update.utime, update.revolution, atlas_.reference(),
                            T_node_base.translation().cast<float>(),
                            Eigen::Quaterniond(T_node_base.linear()).cast<float>()};
  const bool stands = !footprints_.empty() && footprints_.back().node == footprint.node &&
                      (footprints_.back().position - footprint.position).norm() < kFootprint;
  if (!stands) footprints_.push_back(footprint);
  if (!T_odom_base_) return witnesses_.clear();
  witnesses_.push_back({footprint, *T_odom_base_});
  while (update.utime - witnesses_.front().footprint.utime > kWitness) witnesses_.pop_front();
}

Pose Mapper::T_map_of(const Footprint& footprint) const {
  Pose T_node_base = Pose::Identity();
  T_node_base.translation() = footprint.position.cast<double>();
  T_node_base.linear() = footprint.attitude.cast<double>().normalized().toRotationMatrix();
  return atlas_.node(footprint.node).T_map_base * T_node_base;
}

std::vector<Mapper::TrajectoryPoint> Mapper::trajectory() const {
  std::vector<TrajectoryPoint> points;
  points.reserve(footprints_.size());
  for (const Footprint& f : footprints_) points.push_back({f.utime, f.revolution, T_map_of(f)});
  return points;
}

Counters Mapper::counters() const {
  Counters all = counters_;
  for (const Counters* part : {&tracker_.counters(), &closer_.counters()}) {
    for (const auto& [name, value] : part->values()) all.add(name, value);
  }
  return all;
}

}  // namespace curbstone
