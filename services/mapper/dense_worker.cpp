#include "services/mapper/dense_worker.hpp"

#include <utility>

namespace curbstone {

DenseWorker::DenseWorker(const DenseConfig& config, const Pose& T_base_lidar, bool beside)
    : map_(config), T_base_lidar_(T_base_lidar), policy_(beside ? std::launch::async : std::launch::deferred) {}

DenseWorker::~DenseWorker() {
  if (under_way_.valid()) under_way_.wait();
}

void DenseWorker::begin(DenseWork work) {
  wait();
  under_way_ = std::async(policy_, [this, work = std::move(work)] { return work_in(work); });
}

DenseMap& DenseWorker::map() {
  wait();
  return map_;
}

const DenseMap& DenseWorker::map() const {
  wait();
  return map_;
}

std::vector<TileKey> DenseWorker::take_changed() {
  wait();
  return std::exchange(changed_, {});
}

void DenseWorker::wait() const {
  if (!under_way_.valid()) return;
  const std::vector<TileKey> changed = under_way_.get();
  changed_.insert(changed_.end(), changed.begin(), changed.end());
}

std::vector<TileKey> DenseWorker::work_in(const DenseWork& work) {
  std::vector<TileKey> changed;
  const auto take = [&](const std::vector<TileKey>& keys) { changed.insert(changed.end(), keys.begin(), keys.end()); };
  for (const DenseWork::Insertion& i : work.insertions) {
    map_.set_anchor(i.anchor);
    take(map_.insert(i.points, i.T_map_base, i.utime, i.add_new));
  }
  if (!work.look) return changed;
  const DenseWork::Insertion& last = work.insertions.back();
  const auto in_place = [&](std::int32_t anchor) {
    if (anchor == DenseMap::kFixed) return work.look->on_known_map;
    const auto node = static_cast<std::size_t>(anchor);
    return node < work.look->present.size() && work.look->present[node];
  };
  take(map_.look_through(last.points, last.T_map_base, T_base_lidar_, work.look->motion, last.utime, in_place));
  return changed;
}

}  // namespace curbstone
