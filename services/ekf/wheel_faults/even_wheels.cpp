#include "services/ekf/wheel_faults/even_wheels.hpp"

#include <algorithm>
#include <cmath>

namespace curbstone::ekf::wheel_faults {

namespace {

constexpr std::size_t kMinPoints = 6;
constexpr double kOneLeap = 0.5;      // share of the change that, within two intervals, is a leap of the IMU
constexpr double kNoiseSigmas = 5.0;  // sigma of the speed's noise: less is no change
constexpr double kSteadyTime = 0.5;   // s at either end, over which its acceleration is compared

}  // namespace

void EvenWheels::add(const inputs::WheelInterval& interval, double inertial_speed, double noise) {
  if (interval.begin != end_) points_.clear();
  end_ = interval.end;
  Point next;
  if (!points_.empty()) next = points_.back();
  next.seconds += interval.duration();
  for (std::size_t i = 0; i < 2; ++i) next.distance[i] += interval.speed[i] * interval.duration();
  next.inertial_speed = inertial_speed;
  next.variance += noise * noise * interval.duration();
  points_.push_back(next);
  while (duration() > kMaxDuration) points_.pop_front();
  // If the points no longer lie on one line, the newer half may.
  while (points_.size() > 2 && !rolls_evenly())
    points_.erase(points_.begin(), points_.begin() + static_cast<std::ptrdiff_t>(points_.size() / 2));
  even_ = points_.size() >= kMinPoints && duration() >= kMinDuration;
  made_up_ = false;
  change_ = 0.0;
  for (const double span : {kMaxDuration / 4, kMaxDuration / 2, kMaxDuration}) {
    std::size_t from = 0;
    while (next.seconds - points_[from].seconds > span) ++from;
    if (!even_ || made_up_ || next.seconds - points_[from].seconds < kMinDuration || !imu_speed_changed(from)) continue;
    made_up_ = true;
    change_ = next.inertial_speed - points_.front().inertial_speed;
  }
}

bool EvenWheels::rolls_evenly() const {
  const Point& from = points_.front();
  for (std::size_t i = 0; i < 2; ++i) {
    const double speed = (points_.back().distance[i] - from.distance[i]) / duration();
    if (std::abs(speed) < kMinSpeed) return false;
    for (const Point& point : points_) {
      if (std::abs(point.distance[i] - from.distance[i] - speed * (point.seconds - from.seconds)) > kMaxDeviation)
        return false;
    }
  }
  return true;
}

double EvenWheels::acceleration(std::size_t from, std::size_t to) const {
  return (points_[to].inertial_speed - points_[from].inertial_speed) / (points_[to].seconds - points_[from].seconds);
}

/// Whether the IMU's speed has changed since `from`, not in one leap, and now continues as at first.
bool EvenWheels::imu_speed_changed(std::size_t from) const {
  const std::size_t last = points_.size() - 1;
  std::size_t first_end = from + 1;
  while (first_end < last && points_[first_end].seconds - points_[from].seconds < kSteadyTime) ++first_end;
  std::size_t last_begin = last - 1;
  while (last_begin > from && points_[last].seconds - points_[last_begin].seconds < kSteadyTime) --last_begin;
  const double at_first = acceleration(from, first_end);
  const auto changed = [&](std::size_t a, std::size_t b) {  // m/s, beyond the first acceleration
    return std::abs(points_[b].inertial_speed - points_[a].inertial_speed -
                    at_first * (points_[b].seconds - points_[a].seconds));
  };
  double leap = 0.0;
  for (std::size_t i = from + 2; i <= last; ++i) leap = std::max(leap, changed(i - 2, i));
  const double change = changed(from, last);
  const double span = points_[last].seconds - points_[from].seconds;
  // The first acceleration is known only to the noise over half a second, and is extrapolated over the span.
  const double first = points_[first_end].seconds - points_[from].seconds;
  const double of_first = std::sqrt(points_[first_end].variance - points_[from].variance) * span / first;
  const double noise = std::hypot(std::sqrt(points_[last].variance - points_[from].variance), of_first);
  const double limit = kMinChange + kDrift * span + kNoiseSigmas * noise;
  return change > limit && leap < kOneLeap * change && std::abs(acceleration(last_begin, last) - at_first) < kSettled;
}

}  // namespace curbstone::ekf::wheel_faults
