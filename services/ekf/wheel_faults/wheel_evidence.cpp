#include "services/ekf/wheel_faults/wheel_evidence.hpp"

#include <algorithm>
#include <cmath>

namespace curbstone::ekf::wheel_faults {

namespace {

constexpr double kFit = 0.05;            // m/s, noise that is allowed for any explanation
constexpr double kUnexplained = 0.2;     // maximum share of the difference's square
constexpr double kMaxTrackWidths = 1.0;  // track widths by which the configured one may be wrong: a skid steer's
constexpr double kSame = 0.2;  // share of a multiple, and of its distance from 1, within which two are the same
constexpr double kMaxFilterOffset = 0.3;  // m/s, maximum by which wheels pull the filter along before they are refused
constexpr double kTurns = 0.2;            // share of the speed: a wheel that shows less does not turn
constexpr double kUnsure = 0.05;          // m/s, error of a part's mean speed

/// Residual of the sum of squares `yy` after a least-squares fit of x.
double residual_after_fit(double yy, double yx, double xx) {
  return xx > 0 ? yy - yx * yx / xx : yy;
}

}  // namespace

void WheelEvidence::add(const Sample& s) {
  const double d = s.difference;
  const double e = s.expected;
  const double w = s.turn;
  const double t = s.since;
  const std::array<double, kSums> products = {d, e, d * d, d * e, e * e, d * w, w * w, d * t, t * t, 1.0};
  for (std::size_t i = 0; i < kSums; ++i) sums_[i] += s.seconds * products[i];
}

WheelEvidence& WheelEvidence::operator+=(const WheelEvidence& more) {
  for (std::size_t i = 0; i < kSums; ++i) sums_[i] += more.sums_[i];
  return *this;
}

void WheelEvidence::fade(double seconds) {
  for (double& value : sums_) value *= std::max(1.0 - seconds / kMemory, 0.0);
}

double WheelEvidence::noise() const {
  return kFit * kFit * sum(kDuration);
}

double WheelEvidence::scale_residual() const {
  return residual_after_fit(sum(kDiffDiff), sum(kDiffExpected), sum(kExpectedExpected)) + noise();
}

double WheelEvidence::turning_residual() const {
  const double tracks =
      sum(kTurnTurn) > 0 ? std::clamp(sum(kDiffTurn) / sum(kTurnTurn), -kMaxTrackWidths, kMaxTrackWidths) : 0.0;
  return sum(kDiffDiff) - 2.0 * tracks * sum(kDiffTurn) + tracks * tracks * sum(kTurnTurn) + noise();
}

double WheelEvidence::drift_residual() const {
  return residual_after_fit(sum(kDiffDiff), sum(kDiffTime), sum(kTimeTime)) + noise();
}

bool WheelEvidence::has_scale_error(double least) const {
  return std::abs(ratio() - 1.0) >= least && scale_residual() <= kUnexplained * sum(kDiffDiff) &&
         scale_residual() < 0.5 * turning_residual();
}

double WheelEvidence::ratio_without_offset(double offset) const {
  return sum(kExpectedExpected) > 0 ? 1.0 + (sum(kDiffExpected) - offset * sum(kExpected)) / sum(kExpectedExpected)
                                    : 1.0;
}

/// Constant part of the difference in addition to the multiple, m/s, as far as the speeds show it. 0 for a wheel that
/// does not turn.
double WheelEvidence::offset() const {
  const double likely = noise() / (kMaxFilterOffset * kMaxFilterOffset);  // prior weight for a small offset
  const double of_speeds = sum(kExpectedExpected) * (sum(kDuration) + likely) - sum(kExpected) * sum(kExpected);
  if (of_speeds <= 0) return 0.0;
  const double offset =
      std::clamp((sum(kDiff) * sum(kExpectedExpected) - sum(kDiffExpected) * sum(kExpected)) / of_speeds,
                 -kMaxFilterOffset, kMaxFilterOffset);
  return std::abs(ratio_without_offset(offset)) > kTurns ? offset : 0.0;
}

double WheelEvidence::filter_offset() const {
  const double off = offset();
  return off != 0.0 ? std::abs(off / ratio_without_offset(off)) : 0.0;
}

bool WheelEvidence::agrees(const WheelEvidence& part) const {
  if (part.sum(kExpectedExpected) <= 0) return false;
  const double unsure = kUnsure / std::sqrt(part.sum(kExpectedExpected) / part.sum(kDuration));
  const double least = std::min(std::abs(ratio()), std::abs(ratio() - 1.0));
  const double off = offset();
  return std::abs(part.ratio_without_offset(off) - ratio_without_offset(off)) <= kSame * least + unsure;
}

bool WheelEvidence::may_be_drift() const {
  return scale_residual() >= 0.5 * drift_residual();
}

}  // namespace curbstone::ekf::wheel_faults
