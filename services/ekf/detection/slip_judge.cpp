#include "services/ekf/detection/slip_judge.hpp"

namespace curbstone::ekf::detection {

void SlipJudge::judge(const inputs::WheelInterval& interval, const std::array<double, 2>& distances,
                      const model::NavState& state, const model::MotionWindow& window, Counters& counters) {
  const double left = interval.speed[0] * (1.0 + state.wheel_scale[0]);
  const double right = interval.speed[1] * (1.0 + state.wheel_scale[1]);
  const SlipDetector::Signs signs =
      detector_.add({base::kSecondsPerMicrosecond * static_cast<double>(interval.end), 0.5 * (left + right),
                     model::wheel_yaw_rate(state, interval.speed, geometry_), window.motion().angular_rate.z(),
                     window.inertial_speed()});
  const auto hold = static_cast<std::int64_t>(config_.hold / base::kSecondsPerMicrosecond);
  for (std::size_t wheel = 0; wheel < 2; ++wheel) {
    const bool far_off = distances[wheel] > config_.refuse * config_.refuse;
    // Where only the yaw rates disagree, the wheel that is farther off is the one.
    const bool worse = distances[wheel] >= distances[1 - wheel];
    if (!far_off && !signs.speeding && !(signs.turning && worse)) continue;
    if (!slipping(wheel, interval.end)) counters.add(wheel == 0 ? "slips.left" : "slips.right");
    until_[wheel] = interval.end + hold;
  }
  if (signs.turning) counters.add("slip_signs.turning");
  if (signs.speeding) counters.add("slip_signs.speeding");
}

}  // namespace curbstone::ekf::detection
