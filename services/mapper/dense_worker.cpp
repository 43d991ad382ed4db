#include "services/mapper/dense_worker.hpp"

#include <utility>

namespace curbstone {
namespace {

using Keys = std::vector<TileKey>;

void append(Keys& keys, const Keys& more) {
  keys.insert(keys.end(), more.begin(), more.end());
}

void grow(DenseMap& map, const DenseWork& work, Keys& changed) {
  for (const DenseWork::Insertion& i : work.insertions) {
    map.set_anchor(i.anchor);
    append(changed, map.insert(i.points, i.T_map_base, i.utime, i.add_new));
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
         map.look_through(last.points, last.T_map_base, T_base_lidar, work.look->motion, last.utime, in_place));
}

}  // namespace

DenseWorker::DenseWorker(const DenseConfig& config, const Pose& T_base_lidar, bool beside)
    : map_(config), T_base_lidar_(T_base_lidar), policy_(beside ? std::launch::async : std::launch::deferred) {}

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

void DenseWorker::start(const Work& to_look, const Work& to_grow) const {
  wait();
  under_way_ = std::async(policy_, [this, to_look, to_grow] {
    Keys changed;
    if (to_look) look_through(map_, *to_look, T_base_lidar_, changed);
    if (to_grow) {
      grow(map_, *to_grow, changed);
      num_removals_ = map_.num_removals();
    }
    return changed;
  });
}

void DenseWorker::wait() const {
  if (under_way_.valid()) append(changed_, under_way_.get());
}

void DenseWorker::finish() const {
  if (to_look_) start(std::exchange(to_look_, nullptr), nullptr);
  wait();
}

DenseMap& DenseWorker::map() {
  finish();
  num_removals_.reset();
  return map_;
}

const DenseMap& DenseWorker::map() const {
  finish();
  return map_;
}

const DenseMap& DenseWorker::grown() const {
  wait();
  return map_;
}

std::int64_t DenseWorker::num_removals() const {
  wait();
  return num_removals_.value_or(map_.num_removals());
}

std::vector<TileKey> DenseWorker::take_changed() {
  wait();
  return std::exchange(changed_, {});
}

std::vector<TileKey> DenseWorker::take_evicted() {
  wait();
  return map_.take_evicted();
}

}  // namespace curbstone
