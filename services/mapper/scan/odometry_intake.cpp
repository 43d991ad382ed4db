#include "services/mapper/scan/odometry_intake.hpp"

namespace curbstone::mapper::scan {

std::optional<OdometrySample> sample_of(const odometry_t& message) {
  const auto says = [&](std::int32_t flag) { return (message.flags & flag) != 0; };
  const OdometrySample sample{message.utime,
                              pose_from_arrays(message.position, message.orientation),
                              says(odometry_t::INITIALISED),
                              says(odometry_t::STATIONARY),
                              says(odometry_t::TURN_CONFIRMED),
                              !says(odometry_t::NO_IMU)};
  return is_finite(sample.T_odom_base) && message.utime > 0 ? std::optional(sample) : std::nullopt;
}

bool take_odometry(const odometry_t& message, OdometryHistory& history, Counters& counters) {
  const std::optional<OdometrySample> sample = sample_of(message);
  if (!sample) {
    counters.add("refused.odometry");
    return false;
  }
  switch (history.add(*sample)) {
    case OdometryHistory::Added::kYes:
      break;
    case OdometryHistory::Added::kLate:
      counters.add("dropped.odometry_late");
      break;
    case OdometryHistory::Added::kClockJump:
      counters.add("odometry.clock_jumps");
      break;
    case OdometryHistory::Added::kElsewhere:
      counters.add("refused.second_odometry");
      break;
  }
  return true;
}

void add_second_filter_fault(const OdometryHistory& history, std::vector<std::string>& faults) {
  if (history.has_second_filter())
    faults.emplace_back("two filters send on ODOMETRY, and the first is used: end the other curbstone-ekf on the bus");
}

}  // namespace curbstone::mapper::scan
