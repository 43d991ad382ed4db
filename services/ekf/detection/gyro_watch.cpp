#include "services/ekf/detection/gyro_watch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace curbstone::ekf::detection {

namespace {

constexpr std::int64_t kPause = 1'000'000;  // us, after which a run restarts
constexpr int kOften = 15;                  // changes by fine steps, more than coincidence
constexpr int kBlock = 300;                 // changes over which a coarse step is learnt
constexpr int kLongRun = 5;                 // repeats after which an axis is not trusted again yet
constexpr double kMostly = 0.8;  // share of the samples with a change of another axis in which both others change
constexpr std::int64_t kMinRun = 250'000;  // us, shortest run: a gyro with a 5 Hz filter has a new value by then

}  // namespace

void GyroWatch::add(std::int64_t utime, const Eigen::Vector3d& rate, const std::array<bool, 3>& stuck_by_driver,
                    bool drives) {
  const bool begins = last_utime_ == 0 || utime < last_utime_ || utime - last_utime_ > kPause;
  const Eigen::Vector3d change = (rate - last_).cwiseAbs();
  for (const double r : rate.cwiseAbs()) least_ = r > 0 ? std::min(least_, r) : least_;
  last_ = rate;
  last_utime_ = utime;
  if (begins || !drives) stood_ = utime;
  if (begins) {
    all_repeats_ = 0;
    for (Axis& axis : axes_)
      axis = {.stuck = axis.stuck, .since = utime, .changing_since = utime, .change_count = axis.change_count};
  } else {
    learn_steps(change);
    for (std::size_t i = 0; i < axes_.size(); ++i) judge(i, utime, change);
    for (std::size_t i = 0; i < axes_.size(); ++i) check_pair(i, utime, change);
    check_all(utime, change);
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
    if (axis.repeats >= kLongRun) axis.changing_since = utime;
    if (axis.stuck && axis.repeats < kLongRun && utime - axis.changing_since >= kTrust) axis.stuck = false;
    axis.change_count = std::min(axis.change_count + 1, kMinChanges);
    axis.since = utime;
    axis.repeats = 0;
    axis.others_changed = axis.both_others_changed = 0;
    axis.smaller_changes = 0.0;
    return;
  }
  double least = std::numeric_limits<double>::infinity();
  double most = 0.0;
  for (std::size_t k = 0; k < axes_.size(); ++k) {
    if (k == i || axes_[k].stuck) continue;
    least = std::min(least, change[static_cast<Eigen::Index>(k)]);
    most = std::max(most, change[static_cast<Eigen::Index>(k)]);
  }
  axis.repeats = std::min(axis.repeats + 1, kLongRun);
  if (most > 0) ++axis.others_changed;
  if (most > 0 && least > 0) {
    ++axis.both_others_changed;
    axis.smaller_changes += least;
  }
  axis.stuck = axis.stuck || is_proven_stuck(axis, utime);
}

/// Decides, while the third axis changes, whether the two others have got stuck together.
void GyroWatch::check_pair(std::size_t third, std::int64_t utime, const Eigen::Vector3d& change) {
  Axis& axis = axes_[third];
  Axis& one = axes_[(third + 1) % 3];
  Axis& other = axes_[(third + 2) % 3];
  const auto shown = [&](std::size_t i) { return std::abs(last_[static_cast<Eigen::Index>(i)]); };
  if (one.repeats == 0 || other.repeats == 0) {
    axis.changed_meanwhile = axis.others_repeat = 0;
    return;
  }
  ++axis.others_repeat;
  if (change[static_cast<Eigen::Index>(third)] > 0) ++axis.changed_meanwhile;
  const bool zeros = shown((third + 1) % 3) == 0 || shown((third + 2) % 3) == 0;
  if (!has_fine_steps() || one.change_count < kMinChanges || other.change_count < kMinChanges ||
      (zeros && least_ > kFine))
    return;
  const bool is_proven = axis.changed_meanwhile >= kRun && static_cast<double>(axis.changed_meanwhile) >=
                                                               kMostly * static_cast<double>(axis.others_repeat);
  if (is_proven && utime - std::max(one.since, other.since) >= kPair) one.stuck = other.stuck = true;
}

/// Decides whether all axes have got stuck together.
void GyroWatch::check_all(std::int64_t utime, const Eigen::Vector3d& change) {
  all_repeats_ = change.isZero(0.0) ? std::min(all_repeats_ + 1, kRun) : 0;
  if (all_repeats_ < kRun || !has_fine_steps()) return;
  const bool zeros = last_.cwiseAbs().minCoeff() == 0;
  if (zeros && (least_ > kFine || utime - stood_ < kPair)) return;
  const auto got_stuck = [&](const Axis& axis) {
    return axis.change_count >= kMinChanges && utime - axis.since >= kPair;
  };
  if (!std::all_of(axes_.begin(), axes_.end(), got_stuck)) return;
  for (Axis& axis : axes_) axis.stuck = true;
}

bool GyroWatch::has_fine_steps() const {
  return fine_changes_ >= kOften || (step_ > 0 && step_ <= kFine);
}

bool GyroWatch::is_proven_stuck(const Axis& axis, std::int64_t utime) const {
  if (axis.both_others_changed < kRun ||
      static_cast<double>(axis.both_others_changed) < kMostly * static_cast<double>(axis.others_changed) ||
      utime - axis.since < kMinRun)
    return false;
  if (fine_changes_ >= kOften) return true;
  return step_ > 0 && utime - axis.since >= kLong &&
         axis.smaller_changes >= kShaking * step_ * static_cast<double>(axis.both_others_changed);
}

}  // namespace curbstone::ekf::detection
