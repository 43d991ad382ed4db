#include "drivers/lidar/decoding/block_steps.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>

namespace curbstone::lidar::decoding {

namespace {

constexpr int kCircle = 36000;    // 0.01 deg
constexpr int kStepBack = 1000;   // a backward step of less than this is one; a larger one is a wide blind zone
constexpr int kMaxStep = 100;     // more than any motor speed: 20, 40, 80 at 5, 10, 20 Hz
constexpr int kMinStep = 3;       // slower: the head stands, or its azimuth is stuck; the bytes do not show which
constexpr int kMinTolerance = 8;  // rounding and jitter; the steps of a Helios are within 6 of their median

int step(std::uint16_t from, std::uint16_t to) {
  const int forward = (to - from + kCircle) % kCircle;
  return forward > kCircle - kStepBack ? forward - kCircle : forward;
}

int tolerance(int median) {
  return std::max(kMinTolerance, median / 4);
}

}  // namespace

BlockSteps block_steps(std::span<const std::uint16_t> azimuths, const BlindZone& blind_zone, double block_period,
                       std::span<BlockSpan> spans) {
  std::array<int, kMaxBlocks - 1> steps{};
  const std::size_t count = azimuths.size() - 1;
  for (std::size_t i = 0; i < count; ++i) steps[i] = step(azimuths[i], azimuths[i + 1]);
  const std::span<const int> all(steps.data(), count);

  std::array<int, kMaxBlocks - 1> sorted = steps;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(sorted.begin(), middle, sorted.begin() + static_cast<std::ptrdiff_t>(count));
  const int median = *middle;

  BlockSteps result;
  std::optional<std::size_t> odd;
  int odd_steps = 0;
  int turned = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (std::abs(all[i] - median) <= tolerance(median)) {
      turned += all[i];
    } else {
      odd = i;
      ++odd_steps;
    }
  }
  const int even_steps = static_cast<int>(count) - odd_steps;
  result.mean = static_cast<double>(turned) / even_steps;
  if (odd_steps == 1 && median > 0) {
    const int width = (all[*odd] + kCircle) % kCircle;
    if (width > kMaxStep) result.gap = Gap{azimuths[*odd], width};
  }
  const bool blind = result.gap && blind_zone.is(*result.gap);
  result.steady = median <= kMaxStep && median >= kMinStep && (odd_steps == 0 || blind);
  if (!result.steady) return result;

  double start = 0;
  for (std::size_t i = 0; i < azimuths.size(); ++i) {
    spans[i] = {result.mean, start};
    if (i == count) break;
    if (odd == i) {
      start += block_period * result.gap->width / result.mean;
    } else {
      spans[i].angle = all[i];
      start += block_period;
    }
  }
  return result;
}

}  // namespace curbstone::lidar::decoding
