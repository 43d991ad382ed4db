#include "services/mapper/tracking/motion_filter.hpp"

#include <algorithm>

#include "services/mapper/registration/normal_equations.hpp"

namespace curbstone::mapper::tracking {

Pose MotionFilter::take(const Found& found) {
  const double until = found.stride - found.age;
  const Pose T_last_then = found.T_last_base * scan::move(found.assumed, -found.age);
  const registration::Vector6 off = registration::log_of(scan::move(twist_, until).inverse() * T_last_then);
  const double gain = kShare / std::max(until, 0.5 * found.age);  // bounds noise over a very short time
  twist_.linear += gain * off.head<3>();
  twist_.angular += gain * off.tail<3>();
  return T_last_then * scan::move(twist_, found.age);
}

}  // namespace curbstone::mapper::tracking
