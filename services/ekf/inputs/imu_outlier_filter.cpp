#include "services/ekf/inputs/imu_outlier_filter.hpp"

#include <algorithm>
#include <cmath>

namespace curbstone::ekf::inputs {

namespace {

constexpr std::int64_t kMinute = 60'000'000;   // us
constexpr std::int64_t kClockSet = 1'000'000;  // us, step back that means a clock that was set
constexpr std::size_t kMaxRecent = 1'000;      // samples of the last minute that are kept
constexpr double kMaxMultiple = 3.0;           // upper bound of a counted change, as a multiple of the usual one

double limit(double least, double usual_square) {
  return std::max(least, ImuOutlierFilter::kLeaps * std::sqrt(usual_square));
}

/// Mean square over about kMemory. A change counts as at most kMaxMultiple times the usual one, so that leaps do not
/// become usual; on a rough track the limit grows within a second.
void follow(double& usual_square, double least, double change, double share) {
  const double most = std::max(least * least / (ImuOutlierFilter::kLeaps * ImuOutlierFilter::kLeaps), usual_square);
  usual_square += share * (std::min(change * change, kMaxMultiple * kMaxMultiple * most) - usual_square);
}

double change_of(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  return (to - from).cwiseAbs().maxCoeff();
}

}  // namespace

const std::vector<base::ImuSample>& ImuOutlierFilter::add(const base::ImuSample& sample) {
  passed_.clear();
  const base::ImuSample* newest = !held_.empty() ? &held_.back() : last_ ? &*last_ : nullptr;
  const std::int64_t gap = newest != nullptr ? sample.utime - newest->utime : kMaxGap + 1;
  if (gap <= 0 && gap > -kClockSet) {  // late
    passed_.push_back(sample);
  } else if (gap <= 0 || gap > kMaxGap) {  // it cannot be decided whether the held samples are isolated
    reject_held();
    pass(sample);
  } else if (!leaps(*last_, sample)) {
    reject_held();
    learn(*last_, sample);
    pass(sample);
  } else if (held_.size() < kMaxIsolated) {
    held_.push_back(sample);
  } else {
    for (const base::ImuSample& held : held_) {
      learn(*last_, held);
      pass(held);
    }
    held_.clear();
    learn(*last_, sample);
    pass(sample);
  }
  return passed_;
}

bool ImuOutlierFilter::leaps(const base::ImuSample& from, const base::ImuSample& to) const {
  return change_of(from.angular_rate, to.angular_rate) > limit(kMinTurn, turn_) ||
         change_of(from.acceleration, to.acceleration) > limit(kMinForce, force_);
}

void ImuOutlierFilter::learn(const base::ImuSample& from, const base::ImuSample& to) {
  const double share = std::min(base::seconds_between(from.utime, to.utime) / kMemory, 1.0);
  follow(turn_, kMinTurn, change_of(from.angular_rate, to.angular_rate), share);
  follow(force_, kMinForce, change_of(from.acceleration, to.acceleration), share);
}

void ImuOutlierFilter::reject_held() {
  for (const base::ImuSample& held : held_) {
    ++refused_;
    if (recently_rejected_.size() < kMaxRecent) recently_rejected_.push_back(held.utime);
  }
  held_.clear();
}

void ImuOutlierFilter::pass(const base::ImuSample& sample) {
  last_ = sample;
  passed_.push_back(sample);
  std::erase_if(recently_rejected_, [&](std::int64_t utime) { return std::abs(sample.utime - utime) > kMinute; });
}

}  // namespace curbstone::ekf::inputs
