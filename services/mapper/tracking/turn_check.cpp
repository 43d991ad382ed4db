#include "services/mapper/tracking/turn_check.hpp"

#include <cmath>

namespace curbstone::mapper::tracking {

bool TurnCheck::contradicts(std::int64_t utime, const Pose& T_map_base, const Pose& T_odom_base) const {
  return !gives_up(utime) && std::abs(believed_.turned_apart(T_map_base, T_odom_base).z()) > scan::PosePairs::kMostTurn;
}

bool TurnCheck::gives_up(std::int64_t utime) const {
  return believed_.empty() || utime <= believed_.newest() || utime - believed_.newest() > kPatience;
}

}  // namespace curbstone::mapper::tracking
