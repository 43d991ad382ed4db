#include "services/mapper/scan/odometry_intake.hpp"

namespace curbstone::mapper::scan {

namespace {

/// A wheel slips, or one of wheels and gyro is silent.
constexpr std::int32_t kUnconfirmed = +odometry_t::SLIPPING | +odometry_t::NO_IMU | +odometry_t::NO_WHEELS;

}  // namespace

std::optional<OdometrySample> sample_of(const odometry_t& message) {
  const OdometrySample sample{message.utime, pose_from_arrays(message.position, message.orientation),
                              (message.flags & odometry_t::INITIALISED) != 0,
                              (message.flags & odometry_t::STATIONARY) != 0, (message.flags & kUnconfirmed) == 0};
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
  }
  return true;
}

}  // namespace curbstone::mapper::scan
