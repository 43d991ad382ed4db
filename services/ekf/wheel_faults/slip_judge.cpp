#include "services/ekf/wheel_faults/slip_judge.hpp"

#include <cmath>

namespace curbstone::ekf::wheel_faults {

void SlipJudge::judge(const inputs::WheelInterval& interval, const std::array<double, 2>& distances,
                      const std::array<bool, 2>& faulty, const model::NavState& state,
                      const model::MotionWindow& window, Counters& counters) {
  if (faulty != faulty_) detector_.reset();
  faulty_ = faulty;
  const double gyro = window.motion().angular_rate.z();
  double speed = 0.0;  // m/s, mean of both wheels, or the middle's speed from the trusted wheel
  double yaw_rate = model::wheel_yaw_rate(state, interval.speed, geometry_);
  for (std::size_t wheel = 0; wheel < 2; ++wheel) {
    const double arm = (wheel == 0 ? -0.5 : 0.5) * geometry_.track_width * (1.0 + state.wheel_scale[2]);
    const double of_wheel = interval.speed[wheel] * (1.0 + state.wheel_scale[static_cast<int>(wheel)]);
    if (faulty[1 - wheel]) {
      speed = of_wheel - arm * gyro;
      yaw_rate = gyro;
    } else if (!faulty[wheel]) {
      speed += 0.5 * of_wheel;
    }
  }
  if (yaw_rate_unmeasured_) yaw_rate = gyro;
  if (faulty[0] && faulty[1]) {
    detector_.reset();
    return;
  }
  const SlipDetector::Signs signs =
      detector_.add({base::kSecondsPerMicrosecond * static_cast<double>(interval.end), speed, yaw_rate, gyro,
                     window.inertial_speed(), interval.jitter, noise_[0] / std::sqrt(interval.duration()), noise_[1]});
  const auto hold = static_cast<std::int64_t>(config_.hold / base::kSecondsPerMicrosecond);
  for (std::size_t wheel = 0; wheel < 2; ++wheel) {
    if (faulty[wheel]) continue;
    const bool far_off = distances[wheel] > config_.refuse * config_.refuse;
    // If only the yaw rates disagree, the wheel with the larger distance slips.
    const bool worse = distances[wheel] >= distances[1 - wheel];
    if (!far_off && !signs.speeding && !(signs.turning && worse)) continue;
    if (!slipping(wheel, interval.end)) counters.add(wheel == 0 ? "slips.left" : "slips.right");
    until_[wheel] = interval.end + hold;
  }
  if (signs.turning) counters.add("slip_signs.turning");
  if (signs.speeding) counters.add("slip_signs.speeding");
}

void SlipJudge::reject_both(std::int64_t utime) {
  until_.fill(utime + static_cast<std::int64_t>(config_.hold / base::kSecondsPerMicrosecond));
}

}  // namespace curbstone::ekf::wheel_faults
