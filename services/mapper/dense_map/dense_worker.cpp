#include "services/mapper/dense_map/dense_worker.hpp"

#include <stdexcept>
#include <utility>

namespace curbstone::mapper::dense_map {
namespace {

using Keys = std::vector<TileKey>;

void append(Keys& keys, const Keys& more) {
  keys.insert(keys.end(), more.begin(), more.end());
}

void grow(DenseMap& map, const DenseWork& work, Keys& changed) {
  for (const DenseWork::Insertion& i : work.insertions) {
    map.set_anchor(i.anchor);
    map.set_scale(i.scale);
    append(changed, map.insert(*i.points, i.T_map_base, i.utime, i.add_new));
  }
}

void look_through(DenseMap& map, const DenseWork& work, const Pose& T_base_lidar, Keys& changed) {
  const DenseWork::Insertion& last = work.insertions.back();
  const auto in_place = [&](std::int32_t anchor) {
    if (anchor == DenseMap::kFixed) return work.look->on_known_map;
    const auto node = static_cast<std::size_t>(anchor);
    return node < work.look->present.size() && work.look->present[node];
  };
  append(changed,
         map.look_through(*last.points, last.T_map_base, T_base_lidar, work.look->motion, last.utime, in_place));
}

}  // namespace

DenseWorker::DenseWorker(const config::DenseConfig& config, const Pose& T_base_lidar, bool beside,
                         std::shared_ptr<SpillFile> spill_file)
    : map_(config, std::move(spill_file)),
      T_base_lidar_(T_base_lidar),
      policy_(beside ? std::launch::async : std::launch::deferred) {}

DenseWorker::~DenseWorker() {
  if (under_way_.valid()) under_way_.wait();
}

void DenseWorker::begin(DenseWork work) {
  const auto next = std::make_shared<const DenseWork>(std::move(work));
  start(std::exchange(to_look_, nullptr), next);
  if (next->look) to_look_ = next;
}

void DenseWorker::look() {
  if (to_look_) start(std::exchange(to_look_, nullptr), nullptr);
}

void DenseWorker::start(const Work& to_look, const Work& to_grow) {
  wait_grown();
  under_way_ = std::async(policy_, [this, to_look, to_grow] {
    Result result;
    if (to_look) look_through(map_, *to_look, T_base_lidar_, result.changed);
    if (to_grow) {
      grow(map_, *to_grow, result.changed);
      result.grown = {map_.num_removals(), map_.is_moving()};
    }
    return result;
  });
}

void DenseWorker::wait_grown() {
  if (!under_way_.valid()) return;
  const Result result = under_way_.get();
  append(changed_, result.changed);
  grown_ = result.grown.value_or(grown_);
  counters_ = map_.counters();
}

void DenseWorker::wait() {
  look();
  wait_grown();
}

void DenseWorker::load(TileKey key, std::int32_t z_origin, std::int64_t utime, const std::vector<TilePoint>& points) {
  wait();
  map_.load(key, z_origin, utime, points);
  note_change();
}

void DenseWorker::restore(TileKey key, std::int32_t z_origin, TileRecords records, const Eigen::Vector3d& at) {
  wait();
  map_.restore(key, z_origin, std::move(records), at);
  note_change();
}

void DenseWorker::move(const std::vector<Pose>& corrections) {
  wait();
  map_.move(corrections);
  note_change();
}

void DenseWorker::roll_back(std::int64_t utime) {
  wait();
  map_.roll_back(utime);
  note_change();
}

std::vector<TileKey> DenseWorker::finish() {
  wait();
  std::vector<TileKey> changed = map_.finish();
  note_change();
  return changed;
}

void DenseWorker::note_change() {
  grown_ = {map_.num_removals(), map_.is_moving()};
  counters_ = map_.counters();
}

const DenseMap& DenseWorker::map() const {
  if (to_look_) throw std::logic_error("DenseWorker::map: what has left is still to be removed: wait() first");
  return grown();
}

const DenseMap& DenseWorker::grown() const {
  if (under_way_.valid()) throw std::logic_error("DenseWorker: the map is being worked on: wait_grown() first");
  return map_;
}

std::vector<TileKey> DenseWorker::take_changed() {
  return std::exchange(changed_, {});
}

std::vector<TileKey> DenseWorker::take_evicted() {
  (void)grown();
  return map_.take_evicted();
}

}  // namespace curbstone::mapper::dense_map
