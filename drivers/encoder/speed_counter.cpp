#include "drivers/encoder/speed_counter.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace curbstone::encoder {

std::optional<WheelCounter::Sample> SpeedCounter::update(const std::array<double, 2>& speeds, double elapsed) {
  since_accepted_ += elapsed;
  std::array<double, 2> forward{};
  for (std::size_t i = 0; i < 2; ++i) forward[i] = settings_.inverted[i] ? -speeds[i] : speeds[i];
  if (const char* cause = cause_to_refuse(forward)) {
    counters_.add(refusal_ = cause);
    return {};
  }
  WheelCounter::Sample sample;
  for (std::size_t i = 0; i < 2; ++i) {
    if (last_) angle_[i] += 0.5 * ((*last_)[i] + forward[i]) * since_accepted_;
    sample.angle[i] = angle_[i];
    sample.speed[i] = forward[i];
    sample.counts[i] = std::llround(angle_[i] * settings_.counts_per_revolution / (2 * std::numbers::pi));
  }
  last_ = forward;
  since_accepted_ = 0;
  return sample;
}

const char* SpeedCounter::cause_to_refuse(const std::array<double, 2>& forward) {
  for (const double speed : forward) {
    if (!(std::abs(speed) <= settings_.max_speed)) return "refused.jump";
  }
  const double tolerance = 2 * resolution_ + WheelCounter::kBraking * since_accepted_;
  const std::array<double, 2> error = last_ ? std::array{forward[0] - (*last_)[0], forward[1] - (*last_)[1]} : forward;
  if (is_confirmed_) return leap_.refuses(error, tolerance) ? "refused.outlier" : nullptr;
  const bool is_first = !last_;
  is_confirmed_ = !is_first && std::max(std::abs(error[0]), std::abs(error[1])) <= tolerance;
  if (is_confirmed_ || unconfirmed_ == WheelCounter::kMaxUnconfirmed) {
    is_confirmed_ = true;
    return nullptr;
  }
  ++unconfirmed_;
  last_ = forward;
  since_accepted_ = 0;
  return is_first ? "ignored.first" : "refused.outlier";
}

}  // namespace curbstone::encoder
