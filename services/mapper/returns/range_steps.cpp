#include "services/mapper/returns/range_steps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace curbstone::mapper::returns {
namespace {

constexpr std::size_t kStepLasers = 8;  // that are looked at, at most
constexpr float kStepNear = 0.8F;       // m
constexpr float kStepFar = 30.0F;       // m
constexpr float kRounding = 0.005F;     // m: the same range, from rounded coordinates
constexpr std::size_t kMinGaps = 100;   // differences of a look
constexpr float kOffStep = 0.12F;       // of the step
constexpr float kOnStepShare = 0.9F;    // of the differences

/// Differences of successive sorted ranges of each laser, m, beyond kRounding.
std::vector<float> gaps_of(const scan::Scan& scan) {
  std::array<std::vector<float>, 256> ranges;
  std::size_t lasers = 0;
  for (const scan::LidarPoint& point : scan.points) lasers = std::max<std::size_t>(lasers, point.ring + std::size_t{1});
  const std::size_t every = lasers / kStepLasers + 1;
  for (const scan::LidarPoint& point : scan.points) {
    if (point.ring % every != 0) continue;
    const float range = point.position.norm();
    if (range > kStepNear && range < kStepFar) ranges[point.ring].push_back(range);
  }
  std::vector<float> gaps;
  for (std::vector<float>& of : ranges) {
    std::sort(of.begin(), of.end());
    for (std::size_t i = 1; i < of.size(); ++i) {
      if (of[i] - of[i - 1] > kRounding) gaps.push_back(of[i] - of[i - 1]);
    }
  }
  return gaps;
}

/// m; nothing if the differences are no multiples of one coarse step.
std::optional<double> step_of(std::vector<float> gaps) {
  if (gaps.size() < kMinGaps) return std::nullopt;
  const auto least = gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 10);
  std::nth_element(gaps.begin(), least, gaps.end());
  const float step = *least;
  if (step < RangeSteps::kCoarse) return std::nullopt;
  std::size_t on = 0;
  double way = 0, steps = 0;
  for (const float gap : gaps) {
    const float times = std::round(gap / step);
    if (times < 1 || std::abs(gap / step - times) > kOffStep) continue;
    ++on;
    if (times > 3) continue;
    way += static_cast<double>(gap);
    steps += static_cast<double>(times);
  }
  if (static_cast<float>(on) < kOnStepShare * static_cast<float>(gaps.size())) return std::nullopt;
  return way / steps;
}

}  // namespace

void RangeSteps::check(const scan::Scan& scan) {
  if (revolution_++ % kEvery != 0) return;
  const std::optional<double> step = step_of(gaps_of(scan));
  if (step) step_ = *step;
  if (verdict_.add(step.has_value(), scan.start)) counters_.add("faults.lidar.range_steps");
}

std::optional<double> RangeSteps::step() const {
  return verdict_.holds() ? std::optional(step_) : std::nullopt;
}

void RangeSteps::add_faults(std::vector<std::string>& faults) const {
  if (!verdict_.holds()) return;
  faults.push_back(fmt::format(
      "LiDAR: its ranges come in steps of {:.1f} cm, for {:.0f} s: what it sees is up to {:.1f} cm off, and "
      "curbs are missing in the map from there on. Check its firmware and lidar.model, and drive again",
      100 * step_, verdict_.seconds(), 50 * step_));
}

}  // namespace curbstone::mapper::returns
