#include "drivers/encoder/first_period.hpp"

#include <algorithm>
#include <cstdlib>
#include <numeric>

namespace curbstone::encoder {

namespace {

constexpr std::int64_t kJitter = 500;   // us: gaps that differ by no more are alike,
constexpr std::int64_t kShare = 20;     // or by no more than this fraction (1/20) of a gap
constexpr std::int64_t kStep = 100;     // us, resolution of a timer: a measured period is a multiple of it
constexpr std::int64_t kCoarse = 500;   // us, the resolution used if the gaps are uneven
constexpr std::int64_t kOffByMean = 5;  // 1/5: a mean of uneven gaps that differs by less proves nothing

std::int64_t rounded(std::int64_t period, std::int64_t step) {
  return std::max((period + step / 2) / step * step, step);
}

}  // namespace

std::optional<std::int64_t> FirstPeriod::add(std::int64_t received) {
  arrivals_.push_back(received);
  if (explains(nominal_, kFew)) return nominal_;
  if (arrivals_.size() <= kMany) return {};
  if (const std::int64_t period = rounded(mean(kMany), kStep); explains(period, kMany)) return period;
  if (const auto period = mean_of_similar_gaps()) return period;
  if (arrivals_.size() < kMaxSamples) return {};
  const std::int64_t mean_of_all = mean(arrivals_.size() - 1);
  return kOffByMean * std::abs(mean_of_all - nominal_) <= nominal_ ? nominal_ : rounded(mean_of_all, kCoarse);
}

/// Mean of the newest gaps.
std::int64_t FirstPeriod::mean(std::size_t gaps) const {
  return (arrivals_.back() - arrivals_[arrivals_.size() - 1 - gaps]) / static_cast<std::int64_t>(gaps);
}

bool FirstPeriod::explains(std::int64_t period, std::size_t gaps) const {
  if (arrivals_.size() <= gaps) return false;
  std::int64_t earliest = 0;
  std::int64_t latest = 0;
  std::int64_t expected = arrivals_.back();
  for (std::size_t i = arrivals_.size() - 1; i >= arrivals_.size() - gaps; --i) {
    expected -= period;
    earliest = std::min(earliest, arrivals_[i - 1] - expected);
    latest = std::max(latest, arrivals_[i - 1] - expected);
  }
  return 2 * (latest - earliest) < period;
}

/// Mean of the gaps that are alike, if most are: a lost sample makes one that is not.
std::optional<std::int64_t> FirstPeriod::mean_of_similar_gaps() const {
  std::vector<std::int64_t> gaps;
  for (std::size_t i = arrivals_.size() - kMany; i < arrivals_.size(); ++i)
    gaps.push_back(arrivals_[i] - arrivals_[i - 1]);
  std::sort(gaps.begin(), gaps.end());
  const std::int64_t middle = gaps[kMany / 2];
  const auto differs = [&](std::int64_t gap) { return std::abs(gap - middle) > std::max(kJitter, middle / kShare); };
  gaps.erase(std::remove_if(gaps.begin(), gaps.end(), differs), gaps.end());
  if (4 * gaps.size() < 3 * kMany) return {};
  const std::int64_t sum = std::accumulate(gaps.begin(), gaps.end(), std::int64_t{0});
  return rounded(sum / static_cast<std::int64_t>(gaps.size()), kStep);
}

}  // namespace curbstone::encoder
