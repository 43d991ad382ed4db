#include <fmt/format.h>

#include <utility>

#include "services/mapper/tracking/tracker.hpp"

/// @file
/// Tracker: what it believes of odometry.

namespace curbstone::mapper::tracking {
namespace {

constexpr double kLeap = 0.03;       // rad from scan to scan that no vehicle's turning changes by
constexpr int kSparse = 10;          // scans in a row
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

/// Hardly anything came back: fog, dust, an open field, a covered window. That is no reason to doubt odometry, which
/// leads on. Nothing if it cannot: then the scan changes nothing.
std::optional<Tracked> Tracker::pass_over(const scan::Scan& scan, const scan::OdometryHistory& odometry) {
  if (!last_ || first_ || way_.denied() || scan.end <= last_->end) return std::nullopt;
  MotionExpectation expected = expect_motion(config_, recent(), scan, odometry);
  if (!expected.with_odometry) return std::nullopt;
  Attempt none{matcher_.expect(departure(), scan, std::move(expected))};
  none.sparse = true;
  broken_.reset();
  pairs_.interrupt();
  const Last before = *last_;
  Tracked tracked = conclude(scan.end, std::move(none));
  note_odometry(before, odometry);
  return tracked;
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

void Tracker::add_faults(std::vector<std::string>& faults) const {
  way_.add_faults(faults, lidar_yaw_);
  if (sparse_in_a_row_ >= kSparse)
    faults.push_back(
        fmt::format("LiDAR: fewer than {} returns in each of the last {} revolutions: nothing is mapped, and odometry "
                    "alone tells of the way. Fog, dust, an open field, or a covered window?",
                    config_.min_points, sparse_in_a_row_));
}

}  // namespace curbstone::mapper::tracking
