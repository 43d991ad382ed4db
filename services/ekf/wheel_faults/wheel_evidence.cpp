#include "services/ekf/wheel_faults/wheel_evidence.hpp"

#include <algorithm>
#include <cmath>

namespace curbstone::ekf::wheel_faults {

namespace {

constexpr double kFit = 0.05;         // m/s, noise that is allowed for any explanation
constexpr double kUnexplained = 0.2;  // maximum share of the difference's square
constexpr double kMostTrack = 1.0;    // track widths by which the configured one may be wrong: a skid steer's
constexpr double kSame = 0.2;         // share of a multiple, and of its distance from 1, within which two are the same
constexpr double kPulled = 0.3;       // m/s, maximum by which wheels pull the filter along before they are refused
constexpr double kTurns = 0.2;        // share of the speed: a wheel that shows less does not turn
constexpr double kUnsure = 0.05;      // m/s, error of a part's mean speed

/// Residual of the sum of squares `yy` after a least-squares fit of x.
double left_over(double yy, double yx, double xx) {
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
  for (double& sum : sums_) sum *= std::max(1.0 - seconds / kMemory, 0.0);
}

double WheelEvidence::noise() const {
  return kFit * kFit * of(kSeconds);
}

double WheelEvidence::beyond_multiple() const {
  return left_over(of(kDd), of(kDe), of(kEe)) + noise();
}

double WheelEvidence::beyond_turning() const {
  const double tracks = of(kWw) > 0 ? std::clamp(of(kDw) / of(kWw), -kMostTrack, kMostTrack) : 0.0;
  return of(kDd) - 2.0 * tracks * of(kDw) + tracks * tracks * of(kWw) + noise();
}

double WheelEvidence::beyond_drift() const {
  return left_over(of(kDd), of(kDt), of(kTt)) + noise();
}

bool WheelEvidence::shows_multiple(double least) const {
  return std::abs(ratio() - 1.0) >= least && beyond_multiple() <= kUnexplained * of(kDd) &&
         beyond_multiple() < 0.5 * beyond_turning();
}

double WheelEvidence::ratio_beyond(double offset) const {
  return of(kEe) > 0 ? 1.0 + (of(kDe) - offset * of(kE)) / of(kEe) : 1.0;
}

/// Constant part of the difference in addition to the multiple, m/s, as far as the speeds show it. 0 for a wheel that
/// does not turn.
double WheelEvidence::offset() const {
  const double likely = noise() / (kPulled * kPulled);  // prior weight for a small offset
  const double of_speeds = of(kEe) * (of(kSeconds) + likely) - of(kE) * of(kE);
  if (of_speeds <= 0) return 0.0;
  const double offset = std::clamp((of(kD) * of(kEe) - of(kDe) * of(kE)) / of_speeds, -kPulled, kPulled);
  return std::abs(ratio_beyond(offset)) > kTurns ? offset : 0.0;
}

double WheelEvidence::pulled() const {
  const double off = offset();
  return off != 0.0 ? std::abs(off / ratio_beyond(off)) : 0.0;
}

bool WheelEvidence::agrees(const WheelEvidence& part) const {
  if (part.of(kEe) <= 0) return false;
  const double unsure = kUnsure / std::sqrt(part.of(kEe) / part.of(kSeconds));
  const double least = std::min(std::abs(ratio()), std::abs(ratio() - 1.0));
  const double off = offset();
  return std::abs(part.ratio_beyond(off) - ratio_beyond(off)) <= kSame * least + unsure;
}

bool WheelEvidence::may_be_drift() const {
  return beyond_multiple() >= 0.5 * beyond_drift();
}

}  // namespace curbstone::ekf::wheel_faults
