#include "services/mapper/tracking/turn_check.hpp"

#include <cmath>

namespace curbstone::mapper::tracking {

void TurnCheck::add(std::int64_t utime, const Pose& T_map_base, const Pose& T_odom_base) {
  const bool set_back = disagreed_ && utime < *disagreed_;
  if (!disagreed_ || set_back || (!believed_.empty() && disagree(T_map_base, T_odom_base))) disagreed_ = utime;
  believed_.add(utime, T_map_base, T_odom_base);
}

bool TurnCheck::contradicts(std::int64_t utime, const Pose& T_map_base, const Pose& T_odom_base) const {
  return !gives_up(utime) && utime - *disagreed_ > kProbation && disagree(T_map_base, T_odom_base);
}

bool TurnCheck::gives_up(std::int64_t utime) const {
  return believed_.empty() || utime <= believed_.newest() || utime - believed_.newest() > kPatience;
}

bool TurnCheck::disagree(const Pose& T_map_base, const Pose& T_odom_base) const {
  return std::abs(believed_.turned_apart(T_map_base, T_odom_base).z()) > scan::PosePairs::kMaxTurnDifference;
}

}  // namespace curbstone::mapper::tracking
