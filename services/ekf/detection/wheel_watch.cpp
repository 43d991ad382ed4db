#include "services/ekf/detection/wheel_watch.hpp"

#include <algorithm>
#include <cmath>

#include "services/ekf/base/samples.hpp"

namespace curbstone::ekf::detection {

namespace {

constexpr double kForgiven = 0.5;    // s of refusal that a second without is worth
constexpr double kLeastSpeed = 0.3;  // m/s: what agrees more slowly proves little,
constexpr double kSharp = 0.1;       // and so does what is not known to this share
constexpr double kNear = 3.3;        // sigma, as the chi-square gates have it
constexpr double kFar = 5.0;         // sigma, that end an agreement
constexpr double kBefore = 0.5;      // s that a drifting filter takes to be refused
constexpr double kFit = 0.05;        // m/s, to which either explanation may be wrong
constexpr double kTurning = 1.0;     // s of another yaw rate than the gyro's
constexpr double kLeap = 0.5;        // m/s, of the IMU within two intervals and not of the wheels
constexpr double kStroke = 0.8;      // of the first difference within two intervals: at a stroke
constexpr double kMoving = 0.1;      // m/s
constexpr double kFrozen = 0.02;     // of the speed

}  // namespace

void WheelWatch::Wheel::weigh(double speed, double expected, double seconds) {
  product += speed * expected * seconds;
  expected2 += expected * expected * seconds;
}

WheelWatch::Finding WheelWatch::add(const Look& look) {
  const double seconds = base::seconds_between(look.begin, look.end);
  remember(look);
  bool any = false;
  bool all_refused = true;
  for (std::size_t i = 0; i < 2; ++i) {
    if (wheels_[i].faulty) continue;
    any = true;
    all_refused = all_refused && look.refused[i];
  }
  for (std::size_t i = 0; i < 2; ++i) {
    Wheel& wheel = wheels_[i];
    if (wheel.faulty || look.refused[i]) wheel.weigh(look.speed[i], look.expected[i], seconds);
    if (wheel.faulty) {
      judge_faulty(wheel, i, look);
    } else if (!all_refused) {
      judge_alone(wheel, look.refused[i], seconds);
    }
  }
  if (any && all_refused) return dispute(look);
  dispute_.reset();
  return Finding::kNone;
}

void WheelWatch::judge_alone(Wheel& wheel, bool refused, double seconds) const {
  wheel.refused += refused ? seconds : -kForgiven * seconds;
  if (wheel.refused <= 0) wheel = {};
  if (wheel.refused >= config_.patience) wheel.faulty = true;
}

void WheelWatch::judge_faulty(Wheel& wheel, std::size_t i, const Look& look) const {
  const double off = std::abs(look.speed[i] - look.expected[i]);
  const double expected = std::abs(look.expected[i]);
  if (off > kFar * look.sigma[i]) {
    wheel.agreed = 0;
  } else if (off <= kNear * look.sigma[i] && expected > kLeastSpeed && look.sigma[i] < kSharp * expected) {
    wheel.agreed += base::seconds_between(look.begin, look.end);
  }
  if (wheel.agreed >= kAgreement) wheel = {};
}

void WheelWatch::remember(const Look& look) {
  std::rotate(recent_.begin(), recent_.begin() + 1, recent_.end());
  recent_.back() = {0.5 * (look.speed[0] + look.speed[1]), look.inertial_speed};
  remembered_ = std::min(remembered_ + 1, static_cast<int>(recent_.size()));
}

WheelWatch::Finding WheelWatch::dispute(const Look& look) {
  if (!dispute_) {
    dispute_.emplace();
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
  for (std::size_t i = 0; i < 2; ++i) {
    if (wheels_[i].faulty) continue;
    off += look.speed[i] - look.expected[i];
    speed += look.expected[i];
    ++trusted;
  }
  off /= trusted;
  speed /= trusted;
  if (d.intervals == 0) d.first = off;
  const double t = base::seconds_between(d.begin, look.end) + kBefore;
  d.dd += off * off;
  d.dt += off * t;
  d.tt += t * t;
  d.dv += off * speed;
  d.vv += speed * speed;
  d.speed = speed;
  ++d.intervals;
  if (look.turning && trusted == 2) d.turning += base::seconds_between(look.begin, look.end);
  if (base::seconds_between(d.begin, look.end) < config_.patience) return Finding::kNone;
  const Finding finding = settle(d);
  pull_ = d.wheels_leapt > kStroke * std::abs(d.first) ? 0.0 : std::abs(d.first);
  for (Wheel& wheel : wheels_) {
    if (finding == Finding::kWheels) wheel.faulty = true;
    if (finding == Finding::kFilter && !wheel.faulty) wheel = {};
  }
  dispute_.reset();
  return finding;
}

/// What either explanation leaves unexplained: a speed that is a multiple, or a difference that grows with time.
WheelWatch::Finding WheelWatch::settle(const Dispute& d) const {
  if (d.turning >= kTurning) return Finding::kWheels;
  if (d.imu_leapt) return Finding::kFilter;
  const double noise = kFit * kFit * d.intervals;
  const double as_multiple = d.dd - (d.vv > 0 ? d.dv * d.dv / d.vv : 0.0) + noise;
  const double as_drift = d.dd - d.dt * d.dt / d.tt + noise;
  return as_multiple < 0.5 * as_drift ? Finding::kWheels : Finding::kFilter;
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
