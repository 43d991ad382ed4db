#include "services/ekf/detection/gyro_watch.hpp"

#include <algorithm>
#include <cmath>

namespace curbstone::ekf::detection {

namespace {

constexpr std::int64_t kPause = 1'000'000;  // us, after which a run restarts
constexpr int kOften = 15;                  // changes by fine steps, more than coincidence
constexpr int kBlock = 300;                 // changes over which a coarse step is learnt
constexpr int kLongRun = 5;                 // repeats after which an axis is not trusted again yet
constexpr double kMostly = 0.8;  // share of the samples with a change of another axis in which both others change
constexpr std::int64_t kLeast = 250'000;  // us, shortest run: a gyro with a 5 Hz filter has a new value by then

}  // namespace

void GyroWatch::add(std::int64_t utime, const Eigen::Vector3d& rate, const std::array<bool, 3>& stuck_by_driver) {
  const bool begins = last_utime_ == 0 || utime < last_utime_ || utime - last_utime_ > kPause;
  const Eigen::Vector3d change = (rate - last_).cwiseAbs();
  for (const double r : rate.cwiseAbs()) least_ = r > 0 ? std::min(least_, r) : least_;
  last_ = rate;
  last_utime_ = utime;
  if (begins) {
    for (Axis& axis : axes_) axis = {.stuck = axis.stuck, .since = utime, .moved = utime, .lived = axis.lived};
  } else {
    learn_steps(change);
    for (std::size_t i = 0; i < axes_.size(); ++i) judge(i, utime, change);
    for (std::size_t i = 0; i < axes_.size(); ++i) judge_others(i, utime, change);
  }
  for (std::size_t i = 0; i < axes_.size(); ++i) axes_[i].stuck = axes_[i].stuck || stuck_by_driver[i];
}

void GyroWatch::learn_steps(const Eigen::Vector3d& change) {
  if (fine_changes_ >= kOften) return;
  for (const double c : change) {
    if (c <= 0) continue;
    if (c <= kFine) ++fine_changes_;
    block_step_ = changes_ > 0 ? std::min(block_step_, c) : c;
    if (++changes_ < kBlock) continue;
    step_ = block_step_;
    changes_ = 0;
  }
}

void GyroWatch::judge(std::size_t i, std::int64_t utime, const Eigen::Vector3d& change) {
  Axis& axis = axes_[i];
  if (change[static_cast<Eigen::Index>(i)] > 0) {
    if (axis.repeats >= kLongRun) axis.moved = utime;
    if (axis.stuck && axis.repeats < kLongRun && utime - axis.moved >= kTrust) axis.stuck = false;
    axis.lived = std::min(axis.lived + 1, kLived);
    axis.since = utime;
    axis.repeats = 0;
    axis.moving = axis.alone = 0;
    axis.shaking = 0.0;
    return;
  }
  double least = INFINITY;
  double most = 0.0;
  for (std::size_t k = 0; k < axes_.size(); ++k) {
    if (k == i || axes_[k].stuck) continue;
    least = std::min(least, change[static_cast<Eigen::Index>(k)]);
    most = std::max(most, change[static_cast<Eigen::Index>(k)]);
  }
  axis.repeats = std::min(axis.repeats + 1, kLongRun);
  if (most > 0) ++axis.moving;
  if (most > 0 && least > 0) {
    ++axis.alone;
    axis.shaking += least;
  }
  axis.stuck = axis.stuck || proven(axis, utime);
}

/// Decides, while the third axis changes, whether the two others have got stuck together.
void GyroWatch::judge_others(std::size_t third, std::int64_t utime, const Eigen::Vector3d& change) {
  Axis& axis = axes_[third];
  Axis& one = axes_[(third + 1) % 3];
  Axis& other = axes_[(third + 2) % 3];
  const auto shown = [&](std::size_t i) { return std::abs(last_[static_cast<Eigen::Index>(i)]); };
  if (one.repeats == 0 || other.repeats == 0) {
    axis.goes_on = axis.others_repeat = 0;
    return;
  }
  ++axis.others_repeat;
  if (change[static_cast<Eigen::Index>(third)] > 0) ++axis.goes_on;
  const bool zeros = shown((third + 1) % 3) == 0 || shown((third + 2) % 3) == 0;
  const bool fine = fine_changes_ >= kOften || (step_ > 0 && step_ <= kFine);
  if (!fine || one.lived < kLived || other.lived < kLived || (zeros && least_ > kFine)) return;
  const bool proven_so =
      axis.goes_on >= kRun && static_cast<double>(axis.goes_on) >= kMostly * static_cast<double>(axis.others_repeat);
  if (proven_so && utime - std::max(one.since, other.since) >= kPair) one.stuck = other.stuck = true;
}

bool GyroWatch::proven(const Axis& axis, std::int64_t utime) const {
  if (axis.alone < kRun || static_cast<double>(axis.alone) < kMostly * static_cast<double>(axis.moving) ||
      utime - axis.since < kLeast)
    return false;
  if (fine_changes_ >= kOften) return true;
  return step_ > 0 && utime - axis.since >= kLong && axis.shaking >= kShaking * step_ * static_cast<double>(axis.alone);
}

}  // namespace curbstone::ekf::detection
