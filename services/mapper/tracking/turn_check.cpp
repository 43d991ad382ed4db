#include "services/mapper/tracking/turn_check.hpp"

#include <cmath>

#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::tracking {
namespace {

constexpr double kMaxApart = scan::PosePairs::kMaxTurnDifference;
constexpr double kUnexplained = 0.9 * kMaxApart;  // rad: a drift that explains less than a tenth does not count
constexpr double kMinSpan = 0.5;                  // s: over less the noise of two registrations is much of a rate

}  // namespace

void TurnCheck::add(std::int64_t utime, const Pose& T_map_base, const Pose& T_odom_base) {
  const bool set_back = disagreed_ && utime < *disagreed_;
  const double apart = believed_.empty() ? 0 : turned_apart(T_map_base, T_odom_base);
  if (!disagreed_ || set_back || std::abs(apart) > kMaxApart) disagreed_ = utime;
  if (believed_.empty() || set_back) since_ = utime;
  if (utime - since_ > kProbation) follow_drift(utime, apart);
  believed_.add(utime, T_map_base, T_odom_base);
}

/// The mean rate at which they turn apart, over kDriftTime.
void TurnCheck::follow_drift(std::int64_t utime, double apart) {
  const double dt = scan::seconds(believed_.newest(), utime);
  const double span = scan::seconds(believed_.oldest(), utime);
  if (!(dt > 0 && dt < kDriftTime) || span < kMinSpan) return;
  drift_ += (apart / span - drift_) * dt / kDriftTime;
}

bool TurnCheck::contradicts(std::int64_t utime, const Pose& T_map_base, const Pose& T_odom_base) const {
  if (gives_up(utime) || utime - *disagreed_ <= kProbation) return false;
  const double apart = turned_apart(T_map_base, T_odom_base);
  const double by_drift = drift_ * scan::seconds(believed_.oldest(), utime);
  return std::abs(apart) > kMaxApart && std::abs(apart - by_drift) > kUnexplained;
}

bool TurnCheck::gives_up(std::int64_t utime) const {
  return believed_.empty() || utime <= believed_.newest() || utime - believed_.newest() > kPatience;
}

/// rad about the vertical, since the oldest of the believed poses.
double TurnCheck::turned_apart(const Pose& T_map_base, const Pose& T_odom_base) const {
  return believed_.turned_apart(T_map_base, T_odom_base).z();
}

}  // namespace curbstone::mapper::tracking
