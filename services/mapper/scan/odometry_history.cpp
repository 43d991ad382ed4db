#include "services/mapper/scan/odometry_history.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace curbstone::mapper::scan {

namespace {

constexpr std::int64_t kMeasured = 30'000;  // us of samples from which the motion is extrapolated
constexpr std::int64_t kMinGap = 4'000;     // us: one sample at 400 Hz

/// How far a pose may lie from where it is expected.
struct Reach {
  double metres, radians;  // in a second: grows with the time, or with its square, as the expectation is
  int power;
};
constexpr Reach kFastest{40, 10, 1};  // of a vehicle, from its last pose
constexpr Reach kHardest{10, 20, 2};  // of a change of motion, from where its motion leads

bool is_near(const Pose& a, const Pose& b, double dt, const Reach& reach) {
  constexpr double kCorrection = 0.2, kTurnCorrection = 0.1;  // m, rad: a filter corrects itself
  const double grown = std::pow(dt, reach.power);
  return (a.translation() - b.translation()).norm() <= kCorrection + reach.metres * grown &&
         angle_of(a.inverse() * b) <= kTurnCorrection + reach.radians * grown;
}

}  // namespace

OdometryHistory::Added OdometryHistory::add(const OdometrySample& sample) {
  if (!samples_.empty() && sample.utime <= samples_.back().utime) return add_late(sample);
  late_.clear();
  const bool continues_elsewhere =
      !elsewhere_.empty() && is_near(elsewhere_.back().T_odom_base, sample.T_odom_base,
                                     seconds(elsewhere_.back().utime, sample.utime), kFastest);
  if (!samples_.empty() && !leads_to(samples_.size() - 1, sample)) {
    if (!continues_elsewhere) elsewhere_.clear();
    elsewhere_.push_back(sample);
    return Added::kElsewhere;
  }
  const bool has_leapt = continues_elsewhere && sample.utime - samples_.back().utime > kMaxGap;
  if (!elsewhere_.empty() && !has_leapt) give_up_second_filter(sample.utime);
  for (const OdometrySample& leapt : std::exchange(elsewhere_, {})) append(leapt);
  append(sample);
  return Added::kYes;
}

OdometryHistory::Added OdometryHistory::add_late(const OdometrySample& sample) {
  const std::int64_t back = samples_.back().utime - sample.utime;
  const bool goes_on =
      !late_.empty() && sample.utime > late_.back().utime && sample.utime - late_.back().utime <= kMaxGap;
  if (!goes_on) late_.clear();
  late_.push_back(sample);
  const std::size_t enough = back < kFarBack ? kAgreeing : kAgreeingFarBack;
  if (back < kSetBack || late_.size() < enough) {
    if (late_.size() > kAgreeingFarBack) late_.pop_front();
    return Added::kLate;
  }
  samples_ = std::exchange(late_, {});
  elsewhere_.clear();
  other_dropped_ = second_filter_ = 0;  // of the clock before
  return Added::kClockJump;
}

/// Gives up what lay elsewhere. Once may be a sample that was wrong; again within kReportedFor is another filter.
void OdometryHistory::give_up_second_filter(std::int64_t utime) {
  elsewhere_.clear();
  if (utime - other_dropped_ < kReportedFor) second_filter_ = utime;
  other_dropped_ = utime;
}

void OdometryHistory::append(const OdometrySample& sample) {
  samples_.push_back(sample);
  if (samples_.size() > kCapacity) samples_.pop_front();
}

bool OdometryHistory::leads_to(std::size_t last, const OdometrySample& sample) const {
  if (sample.utime - samples_[last].utime > kMaxGap) return true;
  const double dt = seconds(samples_[last].utime, sample.utime);
  const bool has_motion = last > 0 && samples_[last].utime - samples_[last - 1].utime <= kMaxGap;
  return has_motion ? is_near(beyond(last, sample.utime), sample.T_odom_base, dt, kHardest)
                    : is_near(samples_[last].T_odom_base, sample.T_odom_base, dt, kFastest);
}

bool OdometryHistory::fill(const OdometrySample& sample) {
  if (samples_.empty() || samples_.size() >= kCapacity || sample.utime >= samples_.back().utime) return false;
  if (sample.utime < samples_.front().utime && (begin_ == 0 || sample.utime < begin_)) return false;
  const std::size_t place = lower_bound(sample.utime);
  if (samples_[place].utime == sample.utime) return false;
  if (place > 0 && !leads_to(place - 1, sample)) return false;
  samples_.insert(samples_.begin() + static_cast<std::ptrdiff_t>(place), sample);
  return true;
}

std::optional<MissingMessages> OdometryHistory::gap(std::int64_t from) const {
  if (samples_.empty()) return std::nullopt;
  const std::int64_t first = samples_.front().utime;
  if (begin_ > 0 && from < first && first - begin_ > kMeasured && first - begin_ <= ResendClient::kMaxMissing)
    return MissingMessages{begin_ - 1, first};
  const auto step = [this](std::size_t i) { return samples_[i + 1].utime - samples_[i].utime; };
  const std::size_t later = lower_bound(from + 1);
  for (std::size_t i = later > 0 ? later - 1 : 0; i + 1 < samples_.size(); ++i) {
    if (step(i) < kMinGap || step(i) > ResendClient::kMaxMissing) continue;
    std::int64_t beside = std::numeric_limits<std::int64_t>::max();
    if (i > 0) beside = step(i - 1);
    if (i + 2 < samples_.size()) beside = std::min(beside, step(i + 1));
    if (static_cast<double>(step(i)) > kGapSteps * static_cast<double>(beside))
      return MissingMessages{samples_[i].utime, samples_[i + 1].utime};
  }
  return std::nullopt;
}

std::size_t OdometryHistory::lower_bound(std::int64_t utime) const {
  const auto it = std::lower_bound(samples_.begin(), samples_.end(), utime,
                                   [](const OdometrySample& s, std::int64_t t) { return s.utime < t; });
  return static_cast<std::size_t>(it - samples_.begin());
}

std::size_t OdometryHistory::num_known() const {
  return std::min(samples_.size(), lower_bound(horizon_ - kLead) + 1);
}

bool OdometryHistory::covers(std::int64_t from, std::int64_t to) const {
  const std::size_t known = num_known();
  if (known == 0 || samples_.front().utime > from || samples_[known - 1].utime + kLead < to) return false;
  std::size_t first = std::min(lower_bound(from), known - 1);
  if (samples_[first].utime > from) --first;
  for (std::size_t i = first;; ++i) {
    if (!samples_[i].usable) return false;
    if (samples_[i].utime >= to || i + 1 == known) return true;
    if (samples_[i + 1].utime - samples_[i].utime > kMaxGap && !is_clock_step(i, known)) return false;
  }
}

bool OdometryHistory::is_clock_step(std::size_t i, std::size_t known) const {
  constexpr double kStands = 0.01;  // m
  const double gap = seconds(samples_[i].utime, samples_[i + 1].utime);
  if (samples_[i + 1].utime - samples_[i].utime >= kMaxClockStep) return false;
  const auto moved = [this](std::size_t j) {
    return (samples_[j + 1].T_odom_base.translation() - samples_[j].T_odom_base.translation()).norm();
  };
  for (const std::size_t beside : {i - 1, i + 1}) {  // for i = 0, i - 1 wraps and is rejected as well
    if (beside >= known - 1 || samples_[beside + 1].utime - samples_[beside].utime > kMaxGap) continue;
    const double speed = moved(beside) / seconds(samples_[beside].utime, samples_[beside + 1].utime);
    return moved(i) <= 0.5 * speed * gap + kStands;
  }
  return false;
}

Pose OdometryHistory::at(std::int64_t utime) const {
  const std::size_t known = num_known();
  const std::size_t after = lower_bound(utime);
  if (after >= known) return beyond(known - 1, utime);
  if (after == 0 || samples_[after].utime <= utime) return samples_[after].T_odom_base;
  const OdometrySample& a = samples_[after - 1];
  const OdometrySample& b = samples_[after];
  const double fraction = static_cast<double>(utime - a.utime) / static_cast<double>(b.utime - a.utime);
  return interpolate(a.T_odom_base, b.T_odom_base, fraction);
}

/// Extrapolates from the sample `last`. The motion is averaged over a few samples, so that a correction by the filter
/// has little effect on it.
Pose OdometryHistory::beyond(std::size_t last, std::int64_t utime) const {
  const OdometrySample& end = samples_[last];
  const std::size_t before = last > 0 && end.utime - samples_[last - 1].utime <= kMaxGap ? last - 1 : last;
  const OdometrySample& begin = samples_[std::min(lower_bound(end.utime - kMeasured), before)];
  const Pose motion = begin.T_odom_base.inverse() * end.T_odom_base;
  return end.T_odom_base * move(twist_of(motion, seconds(begin.utime, end.utime)), seconds(end.utime, utime));
}

bool OdometryHistory::all(std::int64_t from, std::int64_t to, bool OdometrySample::*says) const {
  const std::size_t known = num_known();
  for (std::size_t i = lower_bound(from); i < known && samples_[i].utime <= to; ++i) {
    if (!(samples_[i].*says)) return false;
  }
  return true;
}

bool OdometryHistory::stationary(std::int64_t from, std::int64_t to) const {
  return all(from, to, &OdometrySample::stationary);
}

bool OdometryHistory::turn_confirmed(std::int64_t from, std::int64_t to) const {
  return all(from, to, &OdometrySample::turn_confirmed);
}

bool OdometryHistory::with_gyro(std::int64_t from, std::int64_t to) const {
  return all(from, to, &OdometrySample::with_gyro);
}

const OdometrySample* OdometryHistory::soon_after(std::int64_t utime) const {
  const std::size_t next = lower_bound(utime + 1);
  if (next >= num_known() || samples_[next].utime - utime > kMaxGap) return nullptr;
  return samples_[next].usable ? &samples_[next] : nullptr;
}

std::int64_t OdometryHistory::longest_step(std::int64_t from) const {
  std::int64_t longest = 0;
  const std::size_t known = num_known();
  for (std::size_t i = std::max<std::size_t>(lower_bound(from), 1); i < known; ++i)
    longest = std::max(longest, samples_[i].utime - samples_[i - 1].utime);
  return longest;
}

void OdometryHistory::forget_before(std::int64_t utime) {
  if (utime > newest()) return;
  while (samples_.size() > 1 && samples_[1].utime <= utime) samples_.pop_front();
}

SweepMotion sweep_from(const OdometryHistory& odometry, std::int64_t from, std::int64_t to) {
  SweepMotion sweep;
  const Pose T_end_odom = odometry.at(to).inverse();
  const auto step = static_cast<std::int64_t>(std::llround(sweep.step * 1e6));
  for (std::int64_t t = from; t < to + step; t += step) {
    sweep.T_end_at.push_back(T_end_odom * odometry.at(std::min(t, to)));
  }
  if (sweep.T_end_at.size() < 2) sweep.T_end_at.resize(2, Pose::Identity());
  return sweep;
}

}  // namespace curbstone::mapper::scan
