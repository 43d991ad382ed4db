#include "services/mapper/place_recognition/lowest_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace curbstone::mapper::place_recognition {
namespace {

constexpr float kNoPoint = std::numeric_limits<float>::infinity();
constexpr float kClear = 0.5F;  // m above the lowest point: more than a curb, or than a metre of a steep street rises

}  // namespace

LowestPoints::LowestPoints(float reach)
    : side_(2 * static_cast<int>(std::ceil(reach)) + 1),
      reach_(std::ceil(reach)),
      lowest_(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_), kNoPoint) {}

int LowestPoints::cell(float v) const {
  return std::abs(v) < reach_ ? static_cast<int>(std::floor(v + reach_)) : -1;
}

void LowestPoints::add(const Eigen::Vector3f& point) {
  const int x = cell(point.x()), y = cell(point.y());
  if (x < 0 || y < 0 || !std::isfinite(point.z())) return;
  float& lowest = lowest_[static_cast<std::size_t>(y * side_ + x)];
  lowest = std::min(lowest, point.z());
}

float LowestPoints::at(const Eigen::Vector3f& point) const {
  const int x = cell(point.x()), y = cell(point.y());
  const float z = x < 0 || y < 0 ? kNoPoint : lowest_[static_cast<std::size_t>(y * side_ + x)];
  return z < kNoPoint ? z : std::numeric_limits<float>::quiet_NaN();
}

bool LowestPoints::upright(const Eigen::Vector3f& point) const {
  const int x = cell(point.x()), y = cell(point.y());
  if (x < 0 || y < 0) return false;
  float low = kNoPoint;
  for (int v = std::max(y - 1, 0); v <= std::min(y + 1, side_ - 1); ++v) {
    for (int u = std::max(x - 1, 0); u <= std::min(x + 1, side_ - 1); ++u)
      low = std::min(low, lowest_[static_cast<std::size_t>(v * side_ + u)]);
  }
  return point.z() > low + kClear;
}

std::vector<Eigen::Vector3f> upright(const std::vector<Eigen::Vector3f>& points, const LowestPoints& lowest) {
  std::vector<Eigen::Vector3f> out;
  std::copy_if(points.begin(), points.end(), std::back_inserter(out),
               [&](const Eigen::Vector3f& p) { return lowest.upright(p); });
  return out;
}

}  // namespace curbstone::mapper::place_recognition
