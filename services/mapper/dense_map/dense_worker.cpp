#include "services/mapper/dense_map/dense_worker.hpp"

#include <stdexcept>
#include <utility>

#include "common/bus/levels.hpp"

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

void clear_free_space(DenseMap& map, const DenseWork& work, const Pose& T_base_lidar, Keys& changed) {
  const DenseWork::Insertion& last = work.insertions.back();
  const auto in_place = [&](std::int32_t anchor) {
    if (anchor == DenseMap::kFixed) return work.removal->on_known_map;
    const auto node = static_cast<std::size_t>(anchor);
    return node < work.removal->present.size() && work.removal->present[node];
  };
  append(changed,
         map.clear_free_space(*last.points, last.T_map_base, T_base_lidar, work.removal->motion, last.utime, in_place));
}

}  // namespace

DenseWorker::DenseWorker(const config::DenseConfig& config, const Pose& T_base_lidar, bool threaded,
                         std::shared_ptr<SpillFile> spill_file)
    : map_(config, std::move(spill_file)),
      T_base_lidar_(T_base_lidar),
      policy_(threaded ? std::launch::async : std::launch::deferred) {}

DenseWorker::~DenseWorker() {
  if (under_way_.valid()) under_way_.wait();
}

void DenseWorker::begin(DenseWork work) {
  const auto next = std::make_shared<const DenseWork>(std::move(work));
  start(std::exchange(pending_removal_, nullptr), next);
  if (next->removal) pending_removal_ = next;
}

void DenseWorker::begin_free_space_removal() {
  if (pending_removal_) start(std::exchange(pending_removal_, nullptr), nullptr);
}

void DenseWorker::start(const Work& to_clear, const Work& to_insert) {
  wait_inserted();
  under_way_ = std::async(policy_, [this, to_clear, move = std::exchange(pending_move_, std::nullopt), to_insert] {
    Result result;
    if (to_clear) clear_free_space(map_, *to_clear, T_base_lidar_, result.changed);
    if (move) {
      map_.move(*move);
      result.changed = map_.keys();
    }
    if (to_insert) grow(map_, *to_insert, result.changed);
    if (move || to_insert) result.grown = {map_.num_removals(), map_.is_moving()};
    return result;
  });
}

void DenseWorker::wait_inserted() {
  if (!under_way_.valid()) return;
  const Result result = under_way_.get();
  append(changed_, result.changed);
  grown_ = result.grown.value_or(grown_);
  note_counters();
}

void DenseWorker::wait() {
  begin_free_space_removal();
  if (pending_move_) start(nullptr, nullptr);
  wait_inserted();
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

void DenseWorker::move(std::vector<Pose> corrections) {
  wait();
  pending_move_ = std::move(corrections);
  grown_ = {0, true};
}

void DenseWorker::roll_back(std::int64_t utime) {
  wait();
  map_.roll_back(utime);
  note_change();
  note_all_changed();
}

std::vector<TileKey> DenseWorker::finish() {
  wait();
  std::vector<TileKey> changed = map_.finish();
  note_change();
  return changed;
}

void DenseWorker::note_change() {
  grown_ = {map_.num_removals(), map_.is_moving()};
  note_counters();
}

void DenseWorker::note_counters() {
  counters_ = map_.counters();
  set_level(counters_, "dense.points", map_.size());
}

const DenseMap& DenseWorker::map() const {
  if (pending_removal_) throw std::logic_error("DenseWorker::map: what has left is still to be removed: wait() first");
  return grown();
}

const DenseMap& DenseWorker::grown() const {
  if (under_way_.valid()) throw std::logic_error("DenseWorker: the map is being worked on: wait_inserted() first");
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
