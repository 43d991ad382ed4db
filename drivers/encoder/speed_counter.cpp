#include "drivers/encoder/speed_counter.hpp"

#include <cmath>
#include <numbers>

namespace curbstone::encoder {

std::optional<WheelCounter::Sample> SpeedCounter::update(const std::array<double, 2>& speeds, double elapsed) {
  since_accepted_ += elapsed;
  std::array<double, 2> forward{};
  for (std::size_t i = 0; i < 2; ++i) {
    forward[i] = settings_.inverted[i] ? -speeds[i] : speeds[i];
    if (!(std::abs(forward[i]) <= settings_.max_speed)) {
      counters_.add("refused.jump");
      return {};
    }
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

}  // namespace curbstone::encoder
