#include "services/mapper/returns/dead_lasers.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace curbstone::mapper::returns {
namespace {

constexpr double kComplete = 0.8;           // of the packets of a revolution
constexpr double kForgotten = 0.9998;       // a revolution: a rate that changed is the new one after a minute
constexpr std::int64_t kFollows = 300'000;  // us between two successive revolutions, at most
constexpr std::size_t kNamedLasers = 16;

}  // namespace

void DeadLasers::check(const scan::Scan& scan, bool moved) {
  packets_ = std::max(kForgotten * packets_, static_cast<double>(scan.packets));
  if (scan.packets < kComplete * packets_) return;
  std::array<int, 256> returns{};
  for (const scan::LidarPoint& point : scan.points) ++returns[point.ring];
  int lowest = -1, highest = -1, best = 0;
  for (int ring = 0; ring < 256; ++ring) {
    const int n = returns[static_cast<std::size_t>(ring)];
    if (n < kMin) continue;
    if (lowest < 0) lowest = ring;
    highest = ring;
    best = std::max(best, n);
  }
  if (lowest == highest) return;  // nothing, or one laser
  const bool follows = scan.start > newest_ && scan.start - newest_ < kFollows;
  newest_ = scan.start;
  for (int ring = 0; ring < 256; ++ring) {
    const auto i = static_cast<std::size_t>(ring);
    judge(lasers_[i], returns[i], best, moved && ring > lowest && ring < highest, scan.start, follows);
  }
}

void DeadLasers::judge(Laser& laser, int returns, int best, bool moved_between, std::int64_t utime, bool follows) {
  const int before = laser.returns;
  laser.returns = returns;
  if (returns > 0) {
    laser.silent = laser.between = 0;
    laser.abrupt = false;
    if (returns >= kMin) laser.steady = std::min(laser.steady + 1, kSteady);
    if (laser.dead && ++laser.back >= kBack) laser.dead = false;
    return;
  }
  laser.back = 0;
  if (laser.steady < kSteady || laser.dead) return;
  if (laser.silent++ == 0) {
    laser.since = utime;
    laser.abrupt = follows && kShareOfBest * before >= best;
  }
  if (moved_between) ++laser.between;
  if (laser.silent < kSilent || (!laser.abrupt && laser.between < kBetween)) return;
  laser.dead = true;
  counters_.add("faults.lidar.dead_laser");
}

std::vector<int> DeadLasers::dead() const {
  std::vector<int> rings;
  for (int ring = 0; ring < 256; ++ring) {
    if (lasers_[static_cast<std::size_t>(ring)].dead) rings.push_back(ring);
  }
  return rings;
}

void DeadLasers::add_faults(std::vector<std::string>& faults) const {
  std::vector<int> rings = dead();
  if (rings.empty()) return;
  const std::int64_t since = lasers_[static_cast<std::size_t>(rings.front())].since;
  const std::size_t all = rings.size();
  rings.resize(std::min(all, kNamedLasers));
  faults.push_back(fmt::format(
      "LiDAR: {} of its lasers ({}{}; 0: the lowest) return nothing any more, for {:.0f} s: the map is "
      "sparser from there on. Clean the window, switch it off and on, else have it repaired",
      all, fmt::join(rings, ", "), all > kNamedLasers ? ", ..." : "", static_cast<double>(newest_ - since) * 1e-6));
}

}  // namespace curbstone::mapper::returns
