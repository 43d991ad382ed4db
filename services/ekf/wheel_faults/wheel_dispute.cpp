#include "services/ekf/wheel_faults/wheel_dispute.hpp"

#include <algorithm>
#include <cmath>

#include "services/ekf/base/samples.hpp"

namespace curbstone::ekf::wheel_faults {

namespace {

constexpr double kAllWrong = 0.25;   // share of the speed by which all wheels are wrong: a wrong radius causes less
constexpr int kMostPatiences = 2;    // number of patiences to wait without a decision
constexpr double kTransition = 0.5;  // s, after which the difference has settled
constexpr double kStroke = 0.8;      // share of the first difference that, within two intervals, means at once
constexpr double kAtOnce = 0.6;  // share of the later difference that is a leap; that of wrong wheels grows with speed
constexpr double kMostAstray = 2.0;  // upper bound of the position error, as a multiple of the distance

}  // namespace

void WheelDispute::add(const WheelLook& look, const std::array<bool, 2>& trusted) {
  trusted_ = trusted;
  end_ = look.end;
  const double since = base::seconds_between(begin_, look.end);
  double difference = 0.0;
  double expected = 0.0;
  int wheels = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    if (!trusted[i]) continue;
    if (since > kTransition) {
      parts_[i][part_at(since)].add({look.difference(i), look.expected[i], settings_.track_width * look.yaw_rate,
                                     since + kBefore, look.seconds()});
    }
    difference += look.difference(i);
    expected += look.expected[i];
    ++wheels;
  }
  if (!first_difference_) first_difference_ = difference / wheels;
  expected_speed_ = expected / wheels;
}

void WheelDispute::note(const RecentSpeeds::Leap& leap) {
  if (base::seconds_between(begin_, end_) > kTransition) return;
  if (std::abs(leap.apart) > std::abs(leap_.apart)) leap_.apart = leap.apart;
}

bool WheelDispute::imu_leapt() const {
  if (leap_.imu) return true;
  double difference = 0.0;  // m/s, mean over the wheels
  int wheels = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    if (!trusted_[i]) continue;
    difference += evidence(i).mean_difference();
    ++wheels;
  }
  return wheels > 0 && leap_.apart * difference > 0 && std::abs(leap_.apart) > kAtOnce * std::abs(difference / wheels);
}

/// After a patience without a decision, all time before the newest patience is one part.
std::size_t WheelDispute::part_at(double since) const {
  const double share = since / settings_.patience - patiences_;
  const std::size_t parts = patiences_ > 0 ? kParts - 1 : kParts;
  return kParts - parts + std::min(static_cast<std::size_t>(share * static_cast<double>(parts)), parts - 1);
}

WheelDispute::Finding WheelDispute::finding() const {
  if (imu_leapt()) return Finding::kFilter;
  bool drift = false;
  for (std::size_t i = 0; i < 2; ++i) {
    if (!trusted_[i]) continue;
    const WheelEvidence all = evidence(i);
    const bool same =
        std::all_of(parts_[i].begin(), parts_[i].end(), [&](const auto& part) { return all.agrees(part); });
    if (!same || !all.shows_multiple(kAllWrong)) return Finding::kFilter;
    drift = drift || all.may_be_drift();
  }
  if (!drift) return Finding::kWheels;
  return patiences_ < kMostPatiences ? Finding::kNone : Finding::kFilter;
}

void WheelDispute::await_more() {
  ++patiences_;
  for (std::size_t i = 0; i < 2; ++i) parts_[i] = {evidence(i)};
}

WheelEvidence WheelDispute::evidence(std::size_t wheel) const {
  WheelEvidence all;
  for (const WheelEvidence& part : parts_[wheel]) all += part;
  return all;
}

WheelDispute::Astray WheelDispute::astray(double way) const {
  Astray out;
  out.seconds = base::seconds_between(begin_, end_);
  const double pulled = std::abs(first_difference_.value_or(0.0));
  if (leap_.wheels > kStroke * pulled) return out;
  for (std::size_t i = 0; i < 2; ++i) {
    if (!trusted_[i]) continue;
    const WheelEvidence all = evidence(i);
    const double share = std::min(std::abs(all.ratio() - 1.0) / std::max(std::abs(all.ratio()), kFrozen), kMostAstray);
    out.speed = std::max({out.speed, pulled, all.pulled()});
    out.place = std::max(out.place, share * way);
  }
  out.place += out.speed * out.seconds;
  return out;
}

}  // namespace curbstone::ekf::wheel_faults
