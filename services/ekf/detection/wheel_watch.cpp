#include "services/ekf/detection/wheel_watch.hpp"

#include <algorithm>
#include <cmath>

#include "services/ekf/base/samples.hpp"

namespace curbstone::ekf::detection {

namespace {

constexpr double kForgiven = 0.5;    // s of refusal that a second without is worth
constexpr double kOneWrong = 0.05;   // of the speed, by which one wheel is: a flat tyre is less,
constexpr double kAllWrong = 0.25;   // and by which all are: a wrong radius is less
constexpr double kLeastSpeed = 0.3;  // m/s: what agrees more slowly proves little,
constexpr double kSharp = 0.1;       // and so does what is not known to this share
constexpr double kNear = 3.3;        // sigma, as the chi-square gates have it
constexpr double kFar = 5.0;         // sigma, that end an agreement
constexpr double kBefore = 0.5;      // s that a drifting filter takes to be refused
constexpr int kUndecided = 2;        // times that it waits for another patience
constexpr double kTransition = 0.5;  // s, in which it is neither as it was nor as it will be
constexpr double kLeap = 0.5;        // m/s, of the IMU within two intervals and not of the wheels
constexpr double kStroke = 0.8;      // of the first difference within two intervals: at a stroke
constexpr double kMostAstray = 2.0;  // ways, by which it may be astray
constexpr double kMoving = 0.1;      // m/s

}  // namespace

void WheelWatch::add(const Look& look) {
  remember(look);
  bool any = false;
  bool all_refused = true;
  for (std::size_t i = 0; i < 2; ++i) {
    if (wheels_[i].faulty) continue;
    any = true;
    all_refused = all_refused && look.refused[i];
  }
  for (std::size_t i = 0; i < 2; ++i) {
    if (wheels_[i].faulty)
      judge_faulty(wheels_[i], i, look);
    else if (!all_refused)
      judge_alone(wheels_[i], i, look);
  }
  if (any && all_refused)
    dispute(look);
  else
    dispute_.reset();
  if (!dispute_)
    way_ += 0.5 * std::abs(look.expected[0] + look.expected[1]) * base::seconds_between(look.begin, look.end);
}

WheelEvidence::Sample WheelWatch::sample(const Look& look, std::size_t wheel, std::int64_t since) const {
  return {look.speed[wheel] - look.expected[wheel], look.expected[wheel], track_width_ * look.yaw_rate,
          base::seconds_between(since, look.end) + kBefore, base::seconds_between(look.begin, look.end)};
}

void WheelWatch::judge_alone(Wheel& wheel, std::size_t i, const Look& look) const {
  const double seconds = base::seconds_between(look.begin, look.end);
  wheel.refused = std::min(wheel.refused + (look.refused[i] ? seconds : -kForgiven * seconds), config_.patience);
  if (wheel.refused <= 0) {
    wheel = {};
    return;
  }
  wheel.evidence.fade(seconds);
  wheel.evidence.add(sample(look, i, look.begin));
  wheel.faulty = wheel.refused >= config_.patience && wheel.evidence.shows_multiple(kOneWrong);
}

void WheelWatch::judge_faulty(Wheel& wheel, std::size_t i, const Look& look) const {
  const double seconds = base::seconds_between(look.begin, look.end);
  const double off = std::abs(look.speed[i] - look.expected[i]);
  const double expected = std::abs(look.expected[i]);
  if (off > kFar * look.sigma[i]) {
    wheel.agreed = 0;
  } else if (off <= kNear * look.sigma[i] && expected > kLeastSpeed && look.sigma[i] < kSharp * expected) {
    wheel.agreed += seconds;
  }
  wheel.evidence.fade(seconds);
  wheel.evidence.add(sample(look, i, look.begin));
  if (wheel.agreed >= kAgreement) wheel = {};
}

void WheelWatch::remember(const Look& look) {
  std::rotate(recent_.begin(), recent_.begin() + 1, recent_.end());
  recent_.back() = {0.5 * (look.speed[0] + look.speed[1]), look.inertial_speed};
  remembered_ = std::min(remembered_ + 1, static_cast<int>(recent_.size()));
}

void WheelWatch::dispute(const Look& look) {
  const bool begins = !dispute_;
  if (begins) {
    dispute_ = Dispute{};
    dispute_->begin = look.begin;
    const double by_wheels = std::abs(recent_.back().wheels - recent_.front().wheels);
    const double by_imu = std::abs(recent_.back().inertial - recent_.front().inertial);
    dispute_->wheels_leapt = by_wheels - by_imu;
    dispute_->imu_leapt = remembered_ == static_cast<int>(recent_.size()) && by_imu > by_wheels + kLeap;
  }
  Dispute& d = *dispute_;
  double off = 0;
  double speed = 0;
  int trusted = 0;
  const double since = base::seconds_between(d.begin, look.end);
  const double share = since / config_.patience - d.undecided;
  const std::size_t parts = d.undecided > 0 ? kParts - 1 : kParts;
  const auto part = kParts - parts + std::min(static_cast<std::size_t>(share * static_cast<double>(parts)), parts - 1);
  for (std::size_t i = 0; i < 2; ++i) {
    if (wheels_[i].faulty) continue;
    if (since > kTransition) d.parts[i][part].add(sample(look, i, d.begin));
    off += look.speed[i] - look.expected[i];
    speed += look.expected[i];
    ++trusted;
  }
  if (begins) d.first = off / trusted;
  d.speed = speed / trusted;
  d.end = look.end;
}

WheelWatch::Finding WheelWatch::settle() {
  const Finding finding = dispute_ ? judge(*dispute_) : Finding::kFilter;
  if (finding == Finding::kNone) {
    await_more(*dispute_);
    return finding;
  }
  const bool wrong = finding == Finding::kWheels;
  if (wrong) astray_ = astray(*dispute_);
  for (std::size_t i = 0; i < 2; ++i) {
    if (wheels_[i].faulty) continue;
    wheels_[i] = {};
    if (!wrong) continue;
    wheels_[i].faulty = true;
    wheels_[i].evidence = sum(dispute_->parts[i]);
  }
  dispute_.reset();
  return finding;
}

WheelWatch::Finding WheelWatch::judge(const Dispute& d) const {
  if (d.imu_leapt) return Finding::kFilter;
  bool drift = false;
  for (std::size_t i = 0; i < 2; ++i) {
    if (wheels_[i].faulty) continue;
    const WheelEvidence all = sum(d.parts[i]);
    const bool same = std::all_of(d.parts[i].begin(), d.parts[i].end(), [&](const auto& p) { return all.agrees(p); });
    if (!same || !all.shows_multiple(kAllWrong)) return Finding::kFilter;
    drift = drift || all.may_be_drift();
  }
  if (!drift) return Finding::kWheels;
  return d.undecided < kUndecided ? Finding::kNone : Finding::kFilter;
}

void WheelWatch::await_more(Dispute& d) {
  ++d.undecided;
  for (Parts& parts : d.parts) parts = {sum(parts)};
}

WheelEvidence WheelWatch::sum(const Parts& parts) {
  WheelEvidence all;
  for (const WheelEvidence& part : parts) all += part;
  return all;
}

WheelWatch::Astray WheelWatch::astray(const Dispute& d) const {
  Astray out;
  out.seconds = base::seconds_between(d.begin, d.end);
  if (d.wheels_leapt > kStroke * std::abs(d.first)) return out;
  for (std::size_t i = 0; i < 2; ++i) {
    if (wheels_[i].faulty) continue;
    const WheelEvidence all = sum(d.parts[i]);
    const double share = std::min(std::abs(all.ratio() - 1.0) / std::max(std::abs(all.ratio()), kFrozen), kMostAstray);
    out.speed = std::max({out.speed, std::abs(d.first), all.pulled()});
    out.place = std::max(out.place, share * way_);
  }
  out.place += out.speed * out.seconds;
  return out;
}

void WheelWatch::stand() {
  interrupt();
  way_ = 0;
}

void WheelWatch::interrupt() {
  dispute_.reset();
  remembered_ = 0;
}

bool WheelWatch::hides_motion() const {
  if (dispute_ && std::abs(dispute_->speed) > kMoving) return true;
  return all_faulty() && (std::abs(ratio(0)) < kFrozen || std::abs(ratio(1)) < kFrozen);
}

}  // namespace curbstone::ekf::detection
