#include "services/mapper/detection/range_scale.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/statistics/consistent_median.hpp"

namespace curbstone::mapper::detection {
namespace {

constexpr double kFar = 40.0;        // m, level distance: beyond it a slope looks like another height
constexpr double kDeepest = 5.0;     // times the LiDAR's height, below it
constexpr std::size_t kBins = 100;   // of that depth
constexpr double kMinGround = 0.25;  // of the points below the LiDAR, within a bin of the ground
constexpr std::size_t kMinPoints = 500;
constexpr double kLowestLidar = 0.3;  // m: for a lower one a bin is less than the ground's unevenness

void keep(std::deque<double>& values, double value) {
  values.push_back(value);
  if (values.size() > RangeScale::kStretches) values.pop_front();
}

}  // namespace

void RangeScale::add(const mounting::RegisteredScan& scan) {
  if (!scan.T_odom_base || height_ < kLowestLidar) return interrupt();
  if (!begin_) begin_ = Begin{scan.T_map_base, *scan.T_odom_base};
  const double way = (begin_->T_odom_base.inverse() * *scan.T_odom_base).translation().head<2>().norm();
  if (way < kStretch) return;
  const double seen = (begin_->T_map_base.inverse() * scan.T_map_base).translation().head<2>().norm();
  begin_ = Begin{scan.T_map_base, *scan.T_odom_base};
  const std::optional<double> by_ground = scale_by_ground(*scan.points);
  if (!by_ground) return;
  keep(by_way_, seen / way);
  keep(by_ground_, *by_ground);
  judge();
}

/// How far below the LiDAR most of what is below it lies, by how far the ground does.
std::optional<double> RangeScale::scale_by_ground(const std::vector<scan::LidarPoint>& points) const {
  const double bin = kDeepest * height_ / kBins;
  std::array<std::size_t, kBins> counts{};
  std::size_t below = 0;
  for (const scan::LidarPoint& point : points) {
    const double depth = height_ - static_cast<double>(point.position.z());
    if (!(depth > bin) || !(depth < kDeepest * height_)) continue;
    if (!(point.position.head<2>().norm() < static_cast<float>(kFar))) continue;
    ++below;
    ++counts[static_cast<std::size_t>(depth / bin)];
  }
  if (below < kMinPoints) return std::nullopt;
  std::size_t best = 0, most = 0;
  for (std::size_t i = 1; i + 1 < kBins; ++i) {
    const std::size_t here = counts[i - 1] + counts[i] + counts[i + 1];
    if (here <= most) continue;
    most = here;
    best = i;
  }
  if (static_cast<double>(most) < kMinGround * static_cast<double>(below)) return std::nullopt;
  return (static_cast<double>(best) + 0.5) * bin / height_;
}

void RangeScale::judge() {
  const auto by_way = consistent_median({by_way_.begin(), by_way_.end()}, kSpread, kMinStretches);
  const auto by_ground = consistent_median({by_ground_.begin(), by_ground_.end()}, kSpread, kMinStretches);
  const bool known = by_way && by_ground;
  const bool wrong = known && std::abs(*by_way - 1) > kWrong && std::abs(*by_ground - 1) > kWrong &&
                     std::abs(*by_way / *by_ground - 1) < kAgree;
  if (!known && scale_) return;
  if (wrong && !scale_) counters_.add("faults.lidar.range_scale");
  scale_ = wrong ? by_way : std::nullopt;
}

void RangeScale::add_faults(std::vector<std::string>& faults) const {
  if (!scale_) return;
  faults.push_back(fmt::format(
      "LiDAR: every range is {:.2f} times what it should be, by the ground below it and the way driven, and "
      "the map is wrong: is its unit another (0.5 cm for 1 cm)? Correct lidar.model, or its firmware",
      *scale_));
}

}  // namespace curbstone::mapper::detection
