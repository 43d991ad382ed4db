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

/// How even the steps of a packet are.
struct Evenness {
  int median = 0;                  // 0.01 deg
  int turned = 0;                  // 0.01 deg, sum of the steps near the median
  int num_odd = 0;                 // steps that differ from it
  std::optional<std::size_t> odd;  // the last of these
};

Evenness evenness_of(std::span<const int> steps) {
  std::array<int, kMaxBlocks - 1> sorted{};
  std::ranges::copy(steps, sorted.begin());
  const auto end = sorted.begin() + static_cast<std::ptrdiff_t>(steps.size());
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(sorted.begin(), middle, end);
  Evenness result;
  result.median = *middle;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (std::abs(steps[i] - result.median) <= tolerance(result.median)) {
      result.turned += steps[i];
    } else {
      result.odd = i;
      ++result.num_odd;
    }
  }
  return result;
}

/// The span of each block; `gap_at`: the step that is the blind zone.
void fill_spans(std::span<const int> steps, const BlockSteps& result, std::optional<std::size_t> gap_at,
                double block_period, std::span<BlockSpan> spans) {
  double start = 0;
  for (std::size_t i = 0; i <= steps.size(); ++i) {
    spans[i] = {result.mean, start};
    if (i == steps.size()) break;
    if (gap_at == i) {
      start += block_period * result.gap->width / result.mean;
    } else {
      spans[i].angle = steps[i];
      start += block_period;
    }
  }
}

}  // namespace

BlockSteps block_steps(std::span<const std::uint16_t> azimuths, const BlindZone& blind_zone, double block_period,
                       std::span<BlockSpan> spans) {
  std::array<int, kMaxBlocks - 1> all{};
  const std::span<int> steps(all.data(), azimuths.size() - 1);
  for (std::size_t i = 0; i < steps.size(); ++i) steps[i] = step(azimuths[i], azimuths[i + 1]);
  const auto [median, turned, num_odd, odd] = evenness_of(steps);

  BlockSteps result;
  result.mean = static_cast<double>(turned) / (static_cast<int>(steps.size()) - num_odd);
  if (num_odd == 1 && median > 0) {
    const int width = (steps[*odd] + kCircle) % kCircle;
    if (width > kMaxStep) result.gap = Gap{azimuths[*odd], width};
  }
  const bool blind = result.gap && blind_zone.is(*result.gap);
  result.steady = median <= kMaxStep && median >= kMinStep && (num_odd == 0 || blind);
  if (result.steady) fill_spans(steps, result, odd, block_period, spans);
  return result;
}

void suspect_blind_zone(const BlockSteps& steps, std::optional<std::int64_t> stamp, std::size_t blocks,
                        double block_period, BlindZone& blind_zone) {
  if (!stamp || !steps.gap) return;
  const double without = static_cast<double>(blocks) * block_period * 1e6;
  blind_zone.suspect(*steps.gap, *stamp, without, without + (steps.gap->width / steps.mean - 1) * block_period * 1e6);
}

}  // namespace curbstone::lidar::decoding
