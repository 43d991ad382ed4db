#include <utility>

#include "services/mapper/tracking/tracker.hpp"

/// @file
/// Tracker: what it believes of odometry.

namespace curbstone::mapper::tracking {
namespace {

constexpr double kLeap = 0.03;       // rad from scan to scan that no vehicle's turning changes by
constexpr double kLongestAlone = 5;  // s that a speed is taken for steady

}  // namespace

/// Where odometry has the vehicle now. The last scan before a gap may outrun its odometry: then what it moved itself
/// goes on from where odometry had it a moment ago.
void Tracker::note_odometry(const Last& before, const scan::OdometryHistory& odometry) {
  if (odometry.covers(last_->end, last_->end)) {
    last_->T_odom_base = odometry.at(last_->end);
    last_->odometry_utime = last_->end;
  } else if (before.T_odom_base && last_->end - before.odometry_utime <= scan::OdometryHistory::kMaxGap) {
    last_->T_odom_base = *before.T_odom_base * before.T_map_base.inverse() * last_->T_map_base;
    last_->odometry_utime = before.odometry_utime;
  }
}

/// Now and then: whether odometry goes where two scans alone say.
void Tracker::check_way(const Tracked& tracked, const scan::OdometryHistory& odometry) {
  if (!odometry.covers(tracked.utime, tracked.utime)) return pairs_.interrupt();
  const Pose T_odom_base = odometry.at(tracked.utime);
  const auto pair =
      pairs_.take(tracked.utime, *tracked.points, T_odom_base, way_.in_doubt(), way_.in_doubt() || way_.is_new());
  if (!pair) return;
  const bool was_denied = way_.denied();
  way_.add(*pair);
  if (way_.good() && tracked.registered) agreed_ = Last{tracked.utime, tracked.T_map_base, T_odom_base};
  if (way_.denied() && !was_denied) go_by_scans(*pair, T_odom_base);
}

/// Odometry has led elsewhere since it last agreed with the scans. The vehicle is where their speed has led from there,
/// turned as odometry has it.
void Tracker::go_by_scans(const WayCheck::Pair& pair, const Pose& T_odom_base) {
  scan::Twist twist;
  twist.linear.head<2>() = pair.by_scans / pair.seconds;
  motion_.set(twist);
  twist_ = twist;
  steady_ = 0;
  const double seconds = agreed_ ? scan::seconds(agreed_->end, pair.utime) : 0;
  if (!trust_.tracking() || !(seconds > 0 && seconds < kLongestAlone)) return;
  twist.angular = scan::twist_of(agreed_->T_odom_base->inverse() * T_odom_base, seconds).angular;
  last_->T_map_base = normalised(agreed_->T_map_base * scan::move(twist, seconds));
}

void Tracker::note_turn(const Tracked& tracked, const scan::OdometryHistory& odometry) {
  if (turns_otherwise_) return;
  if (!tracked.with_odometry || !odometry.covers(tracked.utime, tracked.utime)) {
    turns_.clear();
  } else if (tracked.registered) {
    turns_.add(tracked.utime, tracked.T_map_base, odometry.at(tracked.utime));
  }
}

/// Wheels and gyro, if they agree, outvote a registration. Odometry that leaps is no witness.
bool Tracker::contradicts_odometry(const Attempt& found, const scan::Scan& scan,
                                   const scan::OdometryHistory& odometry) const {
  if (!config_.turn_by_odometry || !found.believed || !last_->T_odom_base || !odometry.covers(last_->end, scan.end) ||
      !odometry.turn_confirmed(last_->end, scan.end)) {
    return false;
  }
  const Pose T_odom_base = odometry.at(scan.end);
  const scan::Twist by_odometry = scan::twist_of(last_->T_odom_base->inverse() * T_odom_base, stride_);
  const double leap = (by_odometry.angular - twist_.angular).norm() * stride_;
  return leap < kLeap && turns_.contradicts(scan.end, found.fit.result.T_map_base, T_odom_base);
}

/// The vehicle is where odometry has led to from before the registration began to slide.
Tracker::Attempt Tracker::by_odometry(const scan::Scan& scan, const scan::OdometryHistory& odometry) const {
  Attempt refused{matcher_.expect(departure(), scan, expect_motion(config_, recent(), scan, odometry)), "refused.turn"};
  refused.fit.prior.T_map_base = normalised(turns_.by_odometry(odometry.at(scan.end)));
  return refused;
}

}  // namespace curbstone::mapper::tracking
