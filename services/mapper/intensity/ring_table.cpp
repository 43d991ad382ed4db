#include "services/mapper/intensity/ring_table.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace curbstone::mapper::intensity {

namespace {

constexpr std::uint64_t kMinReturns = 200;  // with an intensity
constexpr double kDeadZeros = 0.42;         // share of 0: lasers in order were measured at up to 0.4
constexpr double kSaturatedAt = 250;        // the median
constexpr double kMinSpread = 0.10;         // of the median, between quartiles: bounds the gain on noise
constexpr double kMinStep = 1.5;            // of 255, likewise

/// The intensity below which a share of the returns with an intensity lies. A value stands for the interval between the
/// middles to its neighbours, so that devices with coarse steps have a quantile between them.
double quantile_of(const RingHistograms::Counts& counts, double total, double share) {
  double below = 0;  // returns up to the middle of the value before
  double last_value = 0;
  bool is_first = true;
  double running = 0;
  for (std::size_t value = 1; value < counts.size(); ++value) {
    if (counts[value] == 0) continue;
    const auto count = static_cast<double>(counts[value]);
    const double middle = running + 0.5 * count;
    const double wanted = share * total;
    if (middle >= wanted) {
      if (is_first) return static_cast<double>(value);
      return last_value + (static_cast<double>(value) - last_value) * (wanted - below) / (middle - below);
    }
    running += count;
    below = middle;
    last_value = static_cast<double>(value);
    is_first = false;
  }
  return last_value;
}

}  // namespace

RingTable::RingTable(const RingHistograms& histograms) {
  rings_.reserve(histograms.rings.size());
  for (const RingHistograms::Counts& counts : histograms.rings) rings_.push_back(ring_of(counts));
}

int RingTable::count(RingState state) const {
  return static_cast<int>(
      std::count_if(rings_.begin(), rings_.end(), [&](const Ring& ring) { return ring.state == state; }));
}

RingTable::Ring RingTable::ring_of(const RingHistograms::Counts& counts) {
  Ring ring;
  const std::uint64_t all = std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
  const std::uint64_t lit = all - counts[0];
  if (all < kMinReturns) return ring;
  if (static_cast<double>(counts[0]) > kDeadZeros * static_cast<double>(all)) {
    ring.state = RingState::kDead;
    return ring;
  }
  if (lit < kMinReturns) return ring;
  const auto total = static_cast<double>(lit);
  const double median = quantile_of(counts, total, 0.5);
  if (median >= kSaturatedAt) {
    ring.state = RingState::kSaturated;
    return ring;
  }
  const double spread =
      std::max({quantile_of(counts, total, 0.75) - quantile_of(counts, total, 0.25), kMinSpread * median, kMinStep});
  ring.state = RingState::kLearned;
  for (std::size_t raw = 1; raw < ring.entries.size(); ++raw) {
    const double value = kMedian + kQuartiles * (static_cast<double>(raw) - median) / spread;
    ring.entries[raw] = static_cast<std::uint8_t>(std::lround(std::clamp(value, 1.0, 255.0)));
  }
  return ring;
}

}  // namespace curbstone::mapper::intensity
