#include "services/mapper/dense_map/range_image.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace curbstone::mapper::dense_map {
namespace {

constexpr float kBeside = 0.08F;   // m: largest vertical distance of a place from a beam that can pass through it
constexpr float kOutside = 0.01F;  // m: tolerance on the other side, for noise
constexpr float kMinRange = 1.0F;  // m: closer returns are of the vehicle itself

/// A monotone substitute for the angle, 0 .. 4, from +x towards +y: half the cost of std::atan2, and even enough.
float quadrant_angle(float x, float y) {
  const float sum = std::abs(x) + std::abs(y);
  if (!(sum > 0)) return 0;
  const float t = y / sum;
  return x < 0 ? 2 - t : y < 0 ? 4 + t : t;
}

}  // namespace

int RangeImage::azimuth_of(float x, float y) {
  return std::min(static_cast<int>(quadrant_angle(x, y) * (kAzimuths / 4)), kAzimuths - 1);
}

RangeImage::RangeImage(const std::vector<scan::LidarPoint>& points, const Pose& T_base_lidar, const scan::Twist& motion)
    : ages_(kAzimuths, 0) {
  const Eigen::Vector3d lever = T_base_lidar.translation();
  const Eigen::Matrix3f to_lidar = T_base_lidar.linear().transpose().cast<float>();
  velocity_ = to_lidar * (motion.linear + motion.angular.cross(lever)).cast<float>();
  const Eigen::Vector3f origin = to_lidar * lever.cast<float>();
  float end = 0;
  std::size_t rings = 0;
  for (const scan::LidarPoint& p : points) {
    end = std::max(end, p.time);
    rings = std::max(rings, std::size_t{p.ring} + 1);
  }
  beams_.resize(rings * kAzimuths);
  std::vector<float> sum(rings);
  std::vector<int> count(rings);
  for (const scan::LidarPoint& p : points) {
    const float age = end - p.time;
    const Eigen::Vector3f d = to_lidar * p.position - origin + age * velocity_;
    const float range = std::sqrt(d.x() * d.x() + d.y() * d.y());
    if (!(range > kMinRange * 0.5F)) continue;
    const float slope = d.z() / range;
    sum[p.ring] += slope;
    ++count[p.ring];
    const auto azimuth = static_cast<std::size_t>(azimuth_of(d.x(), d.y()));
    ages_[azimuth] = age;
    Beam& beam = beams_[p.ring * kAzimuths + azimuth];
    if (beam.range == 0 || range < beam.range) beam = {range, slope};
  }
  for (std::size_t ring = 0; ring < rings; ++ring) {
    if (count[ring] > 0) rows_.push_back({sum[ring] / static_cast<float>(count[ring]), ring});
  }
  std::sort(rows_.begin(), rows_.end(), [](const Row& a, const Row& b) { return a.slope < b.slope; });
  for (const Row& row : rows_) slopes_.push_back(row.slope);
}

Occupancy RangeImage::classify(const Eigen::Vector3f& place, const Margins& margins) const {
  if (rows_.empty()) return Occupancy::kUnknown;
  const auto age = static_cast<std::size_t>(azimuth_of(place.x(), place.y()));
  const Eigen::Vector3f d = place + ages_[age] * velocity_;
  const float range = std::sqrt(d.x() * d.x() + d.y() * d.y());
  if (!(range > kMinRange)) return Occupancy::kUnknown;
  const float slope = d.z() / range;
  const float inside = slope < 0 ? 1.0F : -1.0F;
  const int azimuth = azimuth_of(d.x(), d.y());
  // All are compared: there are few, and the branches of a search would be mispredicted.
  std::uint32_t lower = 0;
  for (const float of_row : slopes_) lower += of_row < slope ? 1U : 0U;
  const std::size_t end = std::min<std::size_t>(lower + 1, rows_.size());
  Occupancy occupancy = Occupancy::kUnknown;
  for (std::size_t row = lower - std::min(lower, 1U); row < end; ++row) {
    const Beam* const beams = beams_.data() + rows_[row].ring * kAzimuths;
    const Beam& own = beams[azimuth];
    const float off = (slope - own.slope) * range;  // m, height of the place above the beam
    if (own.range == 0 || std::abs(off) > kBeside) continue;
    bool through = off * inside > -kOutside;
    for (const int beside : {azimuth + kAzimuths - 1, azimuth, azimuth + 1}) {
      const float reach = beams[beside % kAzimuths].range;
      if (std::abs(reach - range) < margins.hit) return Occupancy::kOccupied;
      through = through && (reach == 0 || reach > range + margins.pass);
    }
    if (through) occupancy = Occupancy::kFree;
  }
  return occupancy;
}

}  // namespace curbstone::mapper::dense_map
