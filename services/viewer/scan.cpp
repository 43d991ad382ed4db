#include "services/viewer/scan.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace curbstone::viewer {
namespace {

constexpr float kMaxRange = 320;  // m: in cm it fits an int16

}  // namespace

Scan::Scan(const Pose& T_base_lidar, int max_points)
    : T_base_lidar_(T_base_lidar.cast<float>()), max_points_(static_cast<std::size_t>(max_points)) {}

bool Scan::put(const lidar_points_t& message) {
  const auto n = static_cast<std::size_t>(std::max(0, message.num_points));
  if (message.x.size() != n || message.y.size() != n || message.z.size() != n || message.intensity.size() != n)
    return false;
  if (message.revolution != revolution_) finish(message.revolution);
  const auto cm = [](float m) { return static_cast<std::int16_t>(std::lround(m * 100)); };
  for (std::size_t i = 0; i < n; ++i) {
    if (counted_++ % stride_ != 0 || filling_.size() >= max_points_) continue;
    const Eigen::Vector3f p = T_base_lidar_ * Eigen::Vector3f(message.x[i], message.y[i], message.z[i]);
    if (!(p.cwiseAbs().maxCoeff() < kMaxRange)) continue;  // also drops NaN
    filling_.push_back({cm(p.x()), cm(p.y()), cm(p.z()), message.intensity[i]});
  }
  return true;
}

/// Ends a revolution. The next one will have about as many points. An odd stride takes points from all rings in turn.
void Scan::finish(std::int32_t next) {
  if (max_points_ > 0) stride_ = (counted_ / max_points_) | 1U;
  counted_ = 0;
  revolution_ = next;
  done_ = std::exchange(filling_, {});
  ++number_;
}

}  // namespace curbstone::viewer
