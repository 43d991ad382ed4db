#include "services/ekf/inputs/stamp_jitter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace curbstone::ekf::inputs {

namespace {

constexpr int kFew = 8;  // samples: fewer are not significant
// The second of four even samples is compared with the parabola through the others. Its error has a standard deviation
// of sqrt(1 + 1/9 + 1 + 1/9) sigma, and a mean magnitude of sqrt(2 / pi) of that. With a parabola an even change of
// speed does not look like jitter.
const double kSigmaByMean = std::sqrt(M_PI / 2) / std::sqrt(20.0 / 9.0);
constexpr double kEven = 0.5;       // minimum travel of a step, as a share of the longest
constexpr double kParabola = 0.25;  // share of a step, by its relative change squared: effect of an uneven acceleration
constexpr double kMinJitter = 3e-4;  // s: less cannot be distinguished from the motion of the wheels
constexpr double kUnsure = 2e-3;     // s: noise of the wheels alone above which a sample is not used

}  // namespace

void StampJitter::add(const base::WheelSample& sample) {
  std::rotate(samples_.begin(), samples_.begin() + 1, samples_.end());
  samples_.back() = sample;
  known_ = std::min(known_ + 1, kPoints);
  if (known_ < kPoints) return;
  std::array<Error, 2> errors;
  const bool left = evaluate(0, errors[0]);
  const bool right = evaluate(1, errors[1]);
  if (!left && !right) return;
  // Both wheels have the same stamps: an error that only one of them shows is slip.
  const bool use_right = right && (!left || errors[1].off < errors[0].off);
  const Error& error = errors[use_right ? 1 : 0];
  learnt_ = std::min(learnt_ + 1, kMemory);
  mean_off_ += (error.off - mean_off_) / learnt_;
  mean_noise_ += (error.noise - mean_noise_) / learnt_;
}

bool StampJitter::evaluate(std::size_t wheel, Error& error) const {
  std::array<double, kPoints> travel{};  // m, since the first
  std::array<double, kPoints> time{};    // s
  double least = std::numeric_limits<double>::infinity();
  double most = 0.0;
  for (std::size_t i = 1; i < kPoints; ++i) {
    travel[i] = radius_ * (samples_[i].angle[wheel] - samples_[0].angle[wheel]);
    time[i] = base::seconds_between(samples_[0].utime, samples_[i].utime);
    least = std::min(least, std::abs(travel[i] - travel[i - 1]));
    most = std::max(most, std::abs(travel[i] - travel[i - 1]));
  }
  const bool one_way = std::abs(travel[3]) > std::max(std::abs(travel[2]), std::abs(travel[1]));
  if (!one_way || least < kEven * most) return false;
  const auto weight = [&](std::size_t of, std::size_t a, std::size_t b) {
    return (travel[1] - travel[a]) * (travel[1] - travel[b]) / ((travel[of] - travel[a]) * (travel[of] - travel[b]));
  };
  error.off = std::abs(time[1] - weight(2, 0, 3) * time[2] - weight(3, 0, 2) * time[3]);
  const double step = time[3] / 3;
  const double change = 3 * (most - least) / std::abs(travel[3]);
  const double in_travel = std::hypot(config_.angle_noise * radius_, config_.speed_noise * step);
  error.noise = std::hypot(in_travel * time[3] / std::abs(travel[3]), kParabola * change * change * step);
  return error.noise < kUnsure;
}

double StampJitter::sigma() const {
  if (learnt_ < kFew) return 0.0;
  const double square = mean_off_ * mean_off_ * kSigmaByMean * kSigmaByMean - mean_noise_ * mean_noise_;
  const double learnt = std::sqrt(std::max(square, 0.0));
  return learnt > std::max(kMinJitter, config_.stamp_noise) ? learnt : 0.0;
}

}  // namespace curbstone::ekf::inputs
