#include "services/ekf/wheel_faults/wheel_watch.hpp"

#include <algorithm>
#include <cmath>

namespace curbstone::ekf::wheel_faults {

namespace {

constexpr double kForgiven = 0.5;        // s of refusal that a second without refusal cancels
constexpr double kOneWrong = 0.05;       // share of the speed by which one wheel is wrong: a flat tyre causes less
constexpr double kMinProvenSpeed = 0.3;  // m/s: agreement at a lower speed proves little
constexpr double kSharp = 0.1;           // share to which the speed must be known: otherwise agreement proves little
constexpr double kNear = 3.3;            // sigma, as in the chi-square gates
constexpr double kFar = 5.0;             // sigma that reset an agreement
constexpr double kMoving = 0.1;          // m/s

}  // namespace

void WheelWatch::add(const WheelObservation& observation) {
  recent_.add(observation);
  const bool any_trusted = !all_faulty();
  const bool all_refused = (faulty(0) || observation.refused[0]) && (faulty(1) || observation.refused[1]);
  for (std::size_t i = 0; i < 2; ++i) {
    if (faulty(i))
      judge_faulty(wheels_[i], i, observation);
    else if (!all_refused)
      judge_trusted(wheels_[i], i, observation);
  }
  if (any_trusted && all_refused)
    dispute(observation);
  else
    end_dispute();
  if (!dispute_) distance_ += 0.5 * std::abs(observation.expected[0] + observation.expected[1]) * observation.seconds();
}

bool WheelWatch::finds_made_up(const inputs::WheelInterval& interval, double inertial_speed, double noise) {
  even_.add(interval, inertial_speed, noise);
  made_up_ = made_up_ && all_faulty();
  if (!even_.made_up() || made_up_) return false;
  made_up_ = true;
  for (Wheel& wheel : wheels_) wheel = {.faulty = true, .evidence = {}};
  end_dispute();
  return true;
}

void WheelWatch::judge_trusted(Wheel& wheel, std::size_t i, const WheelObservation& observation) const {
  const double seconds = observation.refused[i] ? observation.seconds() : -kForgiven * observation.seconds();
  wheel.refused_time = std::min(wheel.refused_time + seconds, config_.patience);
  if (wheel.refused_time <= 0) {
    wheel = {};
    return;
  }
  add_evidence(wheel, i, observation);
  wheel.faulty = wheel.refused_time >= config_.patience && wheel.evidence.has_scale_error(kOneWrong);
}

void WheelWatch::judge_faulty(Wheel& wheel, std::size_t i, const WheelObservation& observation) const {
  const double off = std::abs(observation.difference(i));
  const double expected = std::abs(observation.expected[i]);
  const bool proves = expected > kMinProvenSpeed && observation.sigma[i] < kSharp * expected;
  if (off > kFar * observation.sigma[i] || (made_up_ && even_.even()))
    wheel.agreed_time = 0;
  else if (off <= kNear * observation.sigma[i] && proves)
    wheel.agreed_time += observation.seconds();
  add_evidence(wheel, i, observation);
  if (wheel.agreed_time >= kAgreement) wheel = {};
}

void WheelWatch::add_evidence(Wheel& wheel, std::size_t i, const WheelObservation& observation) const {
  wheel.evidence.fade(observation.seconds());
  wheel.evidence.add({observation.difference(i), observation.expected[i], track_width_ * observation.yaw_rate,
                      observation.seconds() + WheelDispute::kBefore, observation.seconds()});
}

void WheelWatch::dispute(const WheelObservation& observation) {
  if (!dispute_)
    dispute_.emplace(WheelDispute::Settings{config_.patience, track_width_}, observation.begin, recent_.leap());
  dispute_->add(observation, {!faulty(0), !faulty(1)});
  dispute_->update_leap(recent_.leap());
}

WheelWatch::Finding WheelWatch::resolve_dispute() {
  if (!dispute_) return Finding::kFilterWrong;
  const Finding finding = dispute_->finding();
  if (finding == Finding::kUndecided) {
    dispute_->extend();
    return finding;
  }
  if (finding == Finding::kWheelsWrong)
    filter_error_ = filter_restored_ ? WheelDispute::FilterError{} : dispute_->filter_error(distance_);
  for (std::size_t i = 0; i < 2; ++i) {
    if (faulty(i)) continue;
    wheels_[i] = {};
    if (finding == Finding::kWheelsWrong) wheels_[i] = {.faulty = true, .evidence = dispute_->evidence(i)};
  }
  end_dispute();
  return finding;
}

void WheelWatch::end_dispute() {
  dispute_.reset();
  filter_restored_ = false;
}

void WheelWatch::on_filter_restored() {
  interrupt();
  filter_restored_ = true;
}

void WheelWatch::pardon() {
  interrupt();
  if (made_up_) wheels_ = {};
  made_up_ = false;
  even_ = {};
}

void WheelWatch::on_standstill() {
  interrupt();
  distance_ = 0;
}

void WheelWatch::interrupt() {
  end_dispute();
  recent_.interrupt();
}

bool WheelWatch::standstill_unreliable() const {
  if (dispute_ && std::abs(dispute_->expected_speed()) > kMoving) return true;
  return all_faulty() && (std::abs(ratio(0)) < kFrozen || std::abs(ratio(1)) < kFrozen);
}

}  // namespace curbstone::ekf::wheel_faults
