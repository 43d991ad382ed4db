#include "services/mapper/returns/sight_range.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace curbstone::mapper::returns {
namespace {

constexpr float kOwnWindow = 0.3F;  // m from the LiDAR
constexpr int kFewOfLaser = 10;     // returns: its elevation is not known
constexpr int kFewOfBest = 100;     // returns: part of a revolution

struct Laser {
  int returns = 0;
  double down = 0.0;  // sum of the sines below the horizon
};

}  // namespace

bool SightRange::is_short(const scan::Scan& scan) {
  std::array<Laser, 256> lasers{};
  std::vector<float> ranges;
  ranges.reserve(scan.points.size());
  const Eigen::Matrix3f R = T_base_lidar_.linear();
  for (const scan::LidarPoint& point : scan.points) {
    const float range = point.position.norm();
    if (!(range > kOwnWindow) || !std::isfinite(range)) continue;
    ranges.push_back(range);
    Laser& laser = lasers[point.ring];
    ++laser.returns;
    laser.down -= static_cast<double>((R.row(2) * point.position).value() / range);
  }
  const int best = std::ranges::max_element(lasers, {}, &Laser::returns)->returns;
  if (best < kFewOfBest) return false;
  const auto last = static_cast<std::ptrdiff_t>((1.0 - kStray) * static_cast<double>(ranges.size() - 1));
  std::nth_element(ranges.begin(), ranges.begin() + last, ranges.end());
  const auto end = static_cast<double>(ranges[static_cast<std::size_t>(last)]);
  const auto height = static_cast<double>(T_base_lidar_.translation().z());
  int all = 0, above_ground = 0;
  for (const Laser& laser : lasers) {
    if (laser.returns < kFewOfLaser) continue;
    ++all;
    const double down = laser.down / laser.returns;
    if (down < std::sin(kDown) || kToGround * height / down <= end) continue;
    if (laser.returns < (1.0 - kMissing) * best) ++above_ground;
  }
  if (above_ground < kMinLasers || 6 * above_ground < all) return false;
  range_ = end;
  return true;
}

void SightRange::check(const scan::Scan& scan) {
  if (verdict_.add(is_short(scan), scan.start)) counters_.add("faults.lidar.short_sight");
}

void SightRange::add_faults(std::vector<std::string>& faults) const {
  if (!verdict_.holds()) return;
  faults.push_back(fmt::format(
      "LiDAR: nothing comes back from beyond {:.1f} m in any direction, not even from the ground, for {:.0f} "
      "s: the map is narrower from there on. Clean the window; is its range limited (the device's "
      "settings, lidar.max_range), or is there fog?",
      range_, verdict_.seconds()));
}

}  // namespace curbstone::mapper::returns
