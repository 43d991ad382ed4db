#include "drivers/lidar/decoding/block_spans.hpp"

namespace curbstone::lidar::decoding {

namespace {

constexpr int kCircle = 36000;       // 0.01 deg
constexpr int kBlindZoneFrom = 100;  // more than any motor speed gives: 20, 40, 80 at 5, 10, 20 Hz
constexpr int kStepBack = 1000;      // a step back of less than this is one; else a wide blind zone

int step(std::uint16_t from, std::uint16_t to) {
  const int forward = (to - from + kCircle) % kCircle;
  return forward > kCircle - kStepBack ? forward - kCircle : forward;
}

}  // namespace

void block_spans(std::span<const std::uint16_t> azimuths, double nominal, double block_period,
                 std::span<BlockSpan> spans) {
  double start = 0;
  for (std::size_t i = 0; i < azimuths.size(); ++i) {
    spans[i] = {nominal, start};
    if (i + 1 == azimuths.size()) break;
    const int turned = step(azimuths[i], azimuths[i + 1]);
    if (turned <= kBlindZoneFrom) spans[i].angle = turned;
    start += turned > kBlindZoneFrom && nominal > 0 ? block_period * turned / nominal : block_period;
  }
}

double mean_block_step(std::span<const std::uint16_t> azimuths, double otherwise) {
  int turned = 0;
  int steps = 0;
  for (std::size_t i = 0; i + 1 < azimuths.size(); ++i) {
    const int turn = step(azimuths[i], azimuths[i + 1]);
    if (turn > kBlindZoneFrom) continue;
    turned += turn;
    ++steps;
  }
  return steps > 0 ? static_cast<double>(turned) / steps : otherwise;
}

}  // namespace curbstone::lidar::decoding
