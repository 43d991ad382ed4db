#include "services/mapper/registration/ring_features.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "services/mapper/scan/downsample.hpp"

namespace curbstone::mapper::registration {
namespace {

constexpr int kNeighbours = 5;      // on either side
constexpr float kGap = 0.02F;       // rad between two points of a ring: larger means missing returns
constexpr float kRangeStep = 0.3F;  // m of range between neighbouring points: beyond it one occludes the other
constexpr float kAlongRay = 0.02F;  // of the range, on both sides: beyond it the surface is nearly parallel to the ray
constexpr std::int8_t kUnfit = 1, kTaken = 2;

/// One ring, in order of time.
class Ring {
 public:
  Ring(std::vector<const scan::LidarPoint*> points, const Eigen::Vector3f& lidar) : points_(std::move(points)) {
    std::stable_sort(points_.begin(), points_.end(),
                     [](const scan::LidarPoint* a, const scan::LidarPoint* b) { return a->time < b->time; });
    rays_.reserve(points_.size());
    for (const scan::LidarPoint* point : points_) {
      rays_.push_back(point->position - lidar);
      ranges_.push_back(rays_.back().norm());
    }
    state_.assign(points_.size(), 0);
    bend_.assign(points_.size(), 0);
    measure();
    leave_out();
  }

  void choose(const config::LoamConfig& config, RingFeatures& out) {
    const std::size_t n = points_.size();
    const auto sectors = static_cast<std::size_t>(config.sectors);
    for (std::size_t s = 0; s < sectors; ++s) choose(s * n / sectors, (s + 1) * n / sectors, config, out);
  }

 private:
  [[nodiscard]] bool broken_after(std::size_t i) const {
    const float cross = rays_[i].cross(rays_[i + 1]).squaredNorm();
    const float scale = ranges_[i] * ranges_[i + 1];
    return !(cross < kGap * kGap * scale * scale);
  }

  void measure() {
    const std::size_t n = points_.size();
    std::size_t begin = 0;  // of the current stretch without a gap
    for (std::size_t i = 0; i < n; ++i) {
      if (i + 1 < n && !broken_after(i)) continue;
      for (std::size_t k = begin; k <= i; ++k) {
        if (k < begin + kNeighbours || k + kNeighbours > i) {
          state_[k] = kUnfit;
          continue;
        }
        Eigen::Vector3f sum = -static_cast<float>(2 * kNeighbours + 1) * rays_[k];
        for (std::size_t j = k - kNeighbours; j <= k + kNeighbours; ++j) sum += rays_[j];
        bend_[k] = sum.norm() / (2 * kNeighbours);
      }
      begin = i + 1;
    }
  }

  void leave_out() {
    const std::size_t n = points_.size();
    for (std::size_t i = 0; i + 1 < n; ++i) {
      if (ranges_[i] > ranges_[i + 1] + kRangeStep) {
        for (std::size_t k = i + 1 - std::min<std::size_t>(i + 1, kNeighbours); k <= i; ++k) state_[k] = kUnfit;
      } else if (ranges_[i + 1] > ranges_[i] + kRangeStep) {
        for (std::size_t k = i + 1; k < std::min(n, i + 1 + kNeighbours); ++k) state_[k] = kUnfit;
      }
      if (i == 0) continue;
      const float before = ranges_[i] - ranges_[i - 1];
      const float after = ranges_[i + 1] - ranges_[i];
      const float most = kAlongRay * ranges_[i];
      if (before * after > 0 && std::abs(before) > most && std::abs(after) > most) state_[i] = kUnfit;
    }
  }

  void choose(std::size_t begin, std::size_t end, const config::LoamConfig& config, RingFeatures& out) {
    order_.clear();
    for (std::size_t i = begin; i < end; ++i) {
      if (state_[i] != kUnfit) order_.push_back(i);
    }
    std::stable_sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) { return bend_[a] < bend_[b]; });
    int edges = 0;
    for (auto it = order_.rbegin(); it != order_.rend() && edges < config.edges_per_sector; ++it) {
      if (bend_[*it] < static_cast<float>(config.edge_bend)) break;
      if (state_[*it] == kTaken) continue;
      out.edges.push_back(*points_[*it]);
      ++edges;
      for (std::size_t k = *it - kNeighbours; k <= *it + kNeighbours; ++k) {
        if (state_[k] == 0) state_[k] = kTaken;
      }
    }
    int planes = 0;
    for (const std::size_t i : order_) {
      if (!(bend_[i] < static_cast<float>(config.plane_bend))) break;
      if (state_[i] == kTaken) continue;
      out.smooth.push_back(*points_[i]);
      if (planes < config.planes_per_sector && spaced(i)) {
        out.planes.push_back(*points_[i]);
        chosen_.push_back(i);
        ++planes;
      }
    }
    chosen_.clear();
  }

  /// Whether no neighbour has been chosen yet.
  [[nodiscard]] bool spaced(std::size_t i) const {
    return std::none_of(chosen_.begin(), chosen_.end(), [&](std::size_t k) { return k + 1 == i || k == i + 1; });
  }

  std::vector<const scan::LidarPoint*> points_;
  std::vector<Eigen::Vector3f> rays_;
  std::vector<float> ranges_;
  std::vector<float> bend_;
  std::vector<std::int8_t> state_;
  std::vector<std::size_t> order_;
  std::vector<std::size_t> chosen_;
};

}  // namespace

RingFeatures ring_features(const std::vector<scan::LidarPoint>& points, const Eigen::Vector3f& lidar,
                           const config::LoamConfig& config) {
  std::array<std::vector<const scan::LidarPoint*>, 256> rings;
  for (const scan::LidarPoint& point : points) rings[point.ring].push_back(&point);
  RingFeatures out;
  for (auto& ring : rings) {
    if (ring.size() > 2 * kNeighbours) Ring(std::move(ring), lidar).choose(config, out);
  }
  out.planes = scan::downsample(out.planes, config.plane_voxel, config.max_range);
  out.smooth = scan::downsample(out.smooth, config.plane_voxel, config.max_range);
  std::erase_if(out.edges,
                [&](const scan::LidarPoint& p) { return !(p.position.norm() < static_cast<float>(config.max_range)); });
  return out;
}

}  // namespace curbstone::mapper::registration
