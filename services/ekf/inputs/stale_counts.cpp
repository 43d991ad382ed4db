#include "services/ekf/inputs/stale_counts.hpp"

#include <algorithm>
#include <cmath>

namespace curbstone::ekf::inputs {

namespace {

constexpr double kBraking = 60.0;     // rad/s^2, of a wheel: 10 m/s^2 at 0.17 m
constexpr double kMaxStopTime = 0.3;  // s: a wheel that would need longer has leapt and did not turn
constexpr double kMaxAge = 0.5;       // s, longest age of an angle: beyond it the wheel's state is unknown
constexpr double kMinTurn = 0.01;     // rad between two changes: 7 steps of 4096; less is a slow wheel's next step
constexpr double kAlikeShare = 0.3;   // share by which gaps of one period may differ: they end on a sample
constexpr int kSureGaps = 3;          // consecutive gaps

}  // namespace

void StaleCounts::Renewal::add(std::int64_t utime, double new_angle) {
  if (new_angle == angle && changed != 0) {
    repeated = true;
    return;
  }
  const double since = base::seconds_between(changed, utime);
  const bool renewed = repeated && since <= kMaxAge && std::abs(new_angle - angle) >= kMinTurn;
  const bool agrees = renewed && gap > 0 && std::abs(since - gap) <= kAlikeShare * gap;
  alike = agrees ? alike + 1 : (renewed ? 1 : 0);
  gap = renewed ? since : 0.0;
  fresh = repeated ? 0 : fresh + 1;
  if (alike >= kSureGaps) period = (1.0 + kAlikeShare) * gap;
  if (fresh >= kSureGaps) period = 0.0;
  changed = utime;
  angle = new_angle;
  repeated = false;
}

bool StaleCounts::is_stale(const base::WheelSample& sample) {
  if (used_ && sample.utime <= newest_) return false;
  newest_ = sample.utime;
  for (std::size_t i = 0; i < 2; ++i) renewals_[i].add(sample.utime, sample.angle[i]);
  const double since = used_ ? base::seconds_between(used_->utime, sample.utime) : kMaxAge;
  if (since < kMaxAge) {
    for (std::size_t i = 0; i < 2; ++i) {
      const bool same = sample.angle[i] == used_->angle[i];
      const double stops_in = std::min(std::abs(rate_[i]) / kBraking, kMaxStopTime);
      if (same && rate_[i] != 0 && since < std::max(stops_in, renewals_[i].period)) return true;
    }
  }
  for (std::size_t i = 0; i < 2; ++i)
    rate_[i] = used_ && since < kMaxAge ? (sample.angle[i] - used_->angle[i]) / since : 0.0;
  used_ = sample;
  return false;
}

}  // namespace curbstone::ekf::inputs
