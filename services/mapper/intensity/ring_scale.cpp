#include "services/mapper/intensity/ring_scale.hpp"

#include <cmath>
#include <utility>

namespace curbstone::mapper::intensity {

namespace {

constexpr std::int32_t kFirstTable = 10;   // scans
constexpr std::int32_t kLastTable = 1280;  // scans
constexpr double kStride = 0.2;            // m between scans
constexpr float kHalfStrip = 1.2F;         // m to either side: no car parks there
constexpr float kMinAhead = 3.0F;          // m ahead or behind: closer returns may be of the vehicle
constexpr float kMaxAhead = 25.0F;         // m
constexpr float kUneven = 0.10F;           // m above or below the vehicle's plane
constexpr float kSlope = 0.03F;            // and per metre of distance

bool is_road(const Eigen::Vector3f& p) {
  const float along = std::abs(p.x());
  return std::abs(p.y()) < kHalfStrip && along > kMinAhead && along < kMaxAhead &&
         std::abs(p.z()) < kUneven + kSlope * along;
}

}  // namespace

void RingScale::restore(RingHistograms basis) {
  basis_ = std::move(basis);
  learned_ = basis_;
  table_ = std::make_shared<const RingTable>(basis_);
}

void RingScale::learn(const std::vector<scan::LidarPoint>& points, const Pose& T_map_base) {
  if (learned_.scans >= kLastTable) return;
  const Eigen::Vector3d here = T_map_base.translation();
  if (learned_.scans >= kFirstTable && (here - position_).norm() < kStride) return;
  position_ = here;
  for (const scan::LidarPoint& point : points) {
    if (!is_road(point.position)) continue;
    if (point.ring >= learned_.rings.size()) learned_.rings.resize(std::size_t{point.ring} + 1);
    ++learned_.rings[point.ring][point.intensity];
  }
  ++learned_.scans;
  if (learned_.scans >= kFirstTable && learned_.scans >= 2 * basis_.scans) make_table();
}

void RingScale::make_table() {
  basis_ = learned_;
  auto table = std::make_shared<RingTable>(basis_);
  counters_.add("intensity.tables");
  if (const int dead = table->count(RingState::kDead)) counters_.add("intensity.dead_rings", dead);
  if (const int saturated = table->count(RingState::kSaturated)) counters_.add("intensity.saturated_rings", saturated);
  table_ = std::move(table);
}

}  // namespace curbstone::mapper::intensity
