#include "services/ekf/wheel_faults/wheel_dispute.hpp"

#include <algorithm>
#include <cmath>

#include "services/ekf/base/samples.hpp"

namespace curbstone::ekf::wheel_faults {

namespace {

constexpr double kAllWrong = 0.25;   // share of the speed by which all wheels are wrong: a wrong radius causes less
constexpr int kMaxExtensions = 2;    // number of patiences to wait without a decision
constexpr double kTransition = 0.5;  // s, after which the difference has settled
constexpr double kStroke = 0.8;      // share of the first difference that, within two intervals, means at once
constexpr double kAtOnce = 0.6;  // share of the later difference that is a leap; that of wrong wheels grows with speed
constexpr double kMaxErrorRatio = 2.0;  // upper bound of the position error, as a multiple of the distance

}  // namespace

void WheelDispute::add(const WheelObservation& observation, const std::array<bool, 2>& trusted) {
  trusted_ = trusted;
  end_ = observation.end;
  const double since = base::seconds_between(begin_, observation.end);
  double difference = 0.0;
  double expected = 0.0;
  int wheels = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    if (!trusted[i]) continue;
    if (since > kTransition) {
      segments_[i][segment_at(since)].add({observation.difference(i), observation.expected[i],
                                           settings_.track_width * observation.yaw_rate, since + kBefore,
                                           observation.seconds()});
    }
    difference += observation.difference(i);
    expected += observation.expected[i];
    ++wheels;
  }
  if (!first_difference_) first_difference_ = difference / wheels;
  expected_speed_ = expected / wheels;
}

void WheelDispute::update_leap(const RecentSpeeds::Leap& leap) {
  if (base::seconds_between(begin_, end_) > kTransition) return;
  if (std::abs(leap.offset) > std::abs(leap_.offset)) leap_.offset = leap.offset;
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
  return wheels > 0 && leap_.offset * difference > 0 &&
         std::abs(leap_.offset) > kAtOnce * std::abs(difference / wheels);
}

/// After a patience without a decision, all time before the newest patience is one part.
std::size_t WheelDispute::segment_at(double since) const {
  const double share = since / settings_.patience - extensions_;
  const std::size_t segments = extensions_ > 0 ? kSegments - 1 : kSegments;
  return kSegments - segments + std::min(static_cast<std::size_t>(share * static_cast<double>(segments)), segments - 1);
}

WheelDispute::Finding WheelDispute::finding() const {
  if (imu_leapt()) return Finding::kFilterWrong;
  bool drift = false;
  for (std::size_t i = 0; i < 2; ++i) {
    if (!trusted_[i]) continue;
    const WheelEvidence all = evidence(i);
    const bool same =
        std::all_of(segments_[i].begin(), segments_[i].end(), [&](const auto& segment) { return all.agrees(segment); });
    if (!same || !all.has_scale_error(kAllWrong)) return Finding::kFilterWrong;
    drift = drift || all.may_be_drift();
  }
  if (!drift) return Finding::kWheelsWrong;
  return extensions_ < kMaxExtensions ? Finding::kUndecided : Finding::kFilterWrong;
}

void WheelDispute::extend() {
  ++extensions_;
  for (std::size_t i = 0; i < 2; ++i) segments_[i] = {evidence(i)};
}

WheelEvidence WheelDispute::evidence(std::size_t wheel) const {
  WheelEvidence all;
  for (const WheelEvidence& segment : segments_[wheel]) all += segment;
  return all;
}

WheelDispute::FilterError WheelDispute::filter_error(double distance) const {
  FilterError out;
  out.seconds = base::seconds_between(begin_, end_);
  const double pulled = std::abs(first_difference_.value_or(0.0));
  if (leap_.wheels > kStroke * pulled) return out;
  for (std::size_t i = 0; i < 2; ++i) {
    if (!trusted_[i]) continue;
    const WheelEvidence all = evidence(i);
    const double share =
        std::min(std::abs(all.ratio() - 1.0) / std::max(std::abs(all.ratio()), kFrozen), kMaxErrorRatio);
    out.speed = std::max({out.speed, pulled, all.filter_offset()});
    out.position = std::max(out.position, share * distance);
  }
  out.position += out.speed * out.seconds;
  return out;
}

}  // namespace curbstone::ekf::wheel_faults
