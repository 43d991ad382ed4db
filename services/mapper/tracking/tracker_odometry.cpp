#include <fmt/format.h>

#include <utility>

#include "services/mapper/tracking/tracker.hpp"

/// @file
/// Tracker: checks of odometry, and its use without registration.

namespace curbstone::mapper::tracking {
namespace {

constexpr double kMaxTurnChange = 0.03;  // rad, change of the turn from scan to scan that no vehicle makes
constexpr double kSteady = 0.5 * mounting::MountYaw::kTurn;  // rad, a smaller change from scan to scan is a vehicle's
constexpr int kMinSparseForFault = 10;                       // scans in a row that are a fault
constexpr double kMaxSteadyTime = 5;                         // s for which a speed is taken as constant
constexpr double kReach = 0.5;                               // m, within which registration finds the pose by itself
constexpr double kMaxTiltChange = 0.0175;  // rad, change of the tilt from scan to scan that is more likely a leap

double tilt_between(const Pose& a, const Pose& b) {
  return so3_log(Eigen::Quaterniond(a.linear().transpose() * b.linear())).head<2>().norm();
}

/// Share of the scan's points that lie on a surface of the map.
double fitting_share(const registration::RegistrationResult& result) {
  return result.overlap * result.inlier_ratio;
}

}  // namespace

/// Where odometry claims a leap of the tilt, the scan is registered from a constant velocity as well, and the one that
/// fits better is returned. A filter that corrects its tilt at once makes odometry leap, and registration that begins
/// there may end in a false minimum that looks acceptable.
Tracker::Attempt Tracker::without_leap(Attempt by_odometry, const PreviousPose& from, const scan::Scan& scan) {
  MotionPrediction steady = predict_constant_velocity(recent(), scan);
  if (tilt_between(by_odometry.fit.prediction.T_last_base, steady.T_last_base) < kMaxTiltChange) return by_odometry;
  Attempt attempt = judged(matcher_.fit(from, scan, std::move(steady), motion_));
  if (!attempt.believed || fitting_share(attempt.fit.result) <= fitting_share(by_odometry.fit.result))
    return by_odometry;
  counters_.add("odometry.not_believed");
  return attempt;
}

/// Stores odometry's pose at the last scan's end. The last scan before a gap may end after its odometry: then the
/// latest pose by odometry is moved on by the motion of the scans.
void Tracker::note_odometry(const Last& before, const scan::OdometryHistory& odometry) {
  if (odometry.covers(last_->end, last_->end)) {
    last_->T_odom_base = odometry.at(last_->end);
    last_->odometry_utime = last_->end;
  } else if (before.T_odom_base && last_->end - before.odometry_utime <= scan::OdometryHistory::kMaxGap) {
    last_->T_odom_base = *before.T_odom_base * before.T_map_base.inverse() * last_->T_map_base;
    last_->odometry_utime = before.odometry_utime;
  }
}

/// Processes a scan with too few points: fog, dust, an open field, a covered window. That is no reason to doubt
/// odometry, which continues the pose. Nothing, and no change of pose or map, if odometry cannot.
std::optional<Tracked> Tracker::process_sparse(const scan::Scan& scan, const scan::OdometryHistory& odometry) {
  if (!last_ || first_ || odometry_check_.rejects_odometry() || scan.end <= last_->end) return std::nullopt;
  MotionPrediction prediction = predict_motion(config_, recent(), scan, odometry);
  if (!prediction.with_odometry) return std::nullopt;
  Attempt none{matcher_.predict(departure(), scan, std::move(prediction))};
  none.sparse = true;
  broken_.reset();
  pairs_.interrupt();
  const Last before = *last_;
  Tracked tracked = conclude(scan.end, std::move(none));
  note_odometry(before, odometry);
  return tracked;
}

/// Compares odometry's way with that of two scans alone, about once a second.
void Tracker::check_odometry(const Tracked& tracked, const scan::OdometryHistory& odometry) {
  if (!odometry.covers(tracked.utime, tracked.utime)) {
    scale_by_scans_.interrupt();
    return pairs_.interrupt();
  }
  const Pose T_odom_base = odometry.at(tracked.utime);
  scale_by_scans_.add(tracked.utime, *tracked.points, tracked.T_map_base, T_odom_base);
  const auto pair = pairs_.take(tracked.utime, *tracked.points, T_odom_base, odometry_check_.is_suspect(),
                                odometry_check_.is_suspect() || odometry_check_.is_new());
  if (!pair) return;
  const bool was_rejected = odometry_check_.rejects_odometry();
  odometry_check_.add(*pair);
  if (odometry_check_.agrees() && tracked.registered) agreed_ = Last{tracked.utime, tracked.T_map_base};
  if (odometry_check_.rejects_odometry() && !was_rejected) continue_by_scans(*pair);
}

/// Odometry has gone wrong since it last agreed with the scans. Moves the vehicle to where the scans' speed leads from
/// the pose of that time, unless registration has followed there. What it may not have shown is the way along the
/// street; the turn it has shown, and that of odometry may be wrong as well.
void Tracker::continue_by_scans(const OdometryCheck::Pair& pair) {
  scan::Twist twist = twist_;
  twist.linear << pair.by_scans / pair.seconds, 0;
  motion_.set(twist);
  twist_ = twist;
  steady_ = 0;
  const double seconds = agreed_ ? scan::seconds(agreed_->end, pair.utime) : 0;
  if (!tracking_state_.tracking() || !(seconds > 0 && seconds < kMaxSteadyTime)) return;
  twist.angular = scan::twist_of(agreed_->T_map_base.inverse() * last_->T_map_base, seconds).angular;
  const Pose T_map_base = normalised(agreed_->T_map_base * scan::move(twist, seconds));
  if ((T_map_base.translation() - last_->T_map_base.translation()).norm() > kReach) last_->T_map_base = T_map_base;
}

void Tracker::note_turn(const Tracked& tracked, const scan::OdometryHistory& odometry) {
  if (turn_refused_) return;
  if (!tracked.with_odometry || !odometry.covers(tracked.utime, tracked.utime)) {
    turns_.clear();
  } else if (tracked.registered) {
    turns_.add(tracked.utime, tracked.T_map_base, odometry.at(tracked.utime));
  }
}

/// Whether odometry's turn between two scans is measured, and is that of a vehicle: wheels and gyro agree on it, or it
/// changes no faster than a vehicle can.
bool Tracker::turns_steadily(std::int64_t from, std::int64_t to, const scan::OdometryHistory& odometry) const {
  const std::int64_t before = from - (to - from);
  if (!odometry.covers(from, to)) return false;
  if (odometry.turn_confirmed(from, to)) return true;
  if (!odometry.covers(before, to) || !odometry.with_gyro(before, to)) return false;
  const Pose T_middle_odom = odometry.at(from).inverse();
  return angle_of(T_middle_odom * odometry.at(to) * (T_middle_odom * odometry.at(before))) < kSteady;
}

/// Corrects what odometry predicts by what earlier scans show of it: its turn, and the size of its wheels.
MotionPrediction Tracker::corrected(MotionPrediction prediction, const scan::Scan& scan,
                                    const scan::OdometryHistory& odometry) {
  if (const double error = turn_error(prediction.sweep, scan, odometry); error != 0) {
    counters_.add("odometry.turn_by_scans");
    prediction.T_last_base.rotate(Eigen::AngleAxisd(-error, Eigen::Vector3d::UnitZ()));
  }
  if (const double scale = scale_by_scans_.scale(); scale != 1) {
    counters_.add("odometry.scale_by_scans");
    prediction.T_last_base.translation() *= scale;
  }
  return prediction;
}

/// rad, to the left: error of the turn by odometry without a gyro, or with one that the wheels contradict: a wheel that
/// slips turns it, or a gyro that is wrong. 0: unknown. Not by scans of a LiDAR that shakes.
double Tracker::turn_error(const scan::SweepMotion& sweep, const scan::Scan& scan,
                           const scan::OdometryHistory& odometry) {
  const bool is_measured = odometry.with_gyro(last_->end, scan.end) && odometry.turn_confirmed(last_->end, scan.end);
  if (is_measured || mount_.shakes()) {
    turn_by_scans_.interrupt();
    return 0;
  }
  return turn_by_scans_.error_since_last(scan.end, matcher_.in_base(scan, sweep), odometry.at(scan.end));
}

/// Whether the LiDAR has turned in its mount, by a scan that ended at `end`, us. The next scan is de-skewed with the
/// mount's new yaw.
mounting::MountYaw::Result Tracker::observe_mount(const std::vector<scan::LidarPoint>& points, std::int64_t end,
                                                  const scan::OdometryHistory& odometry) {
  const bool is_measured = config_.turn_by_odometry && turns_steadily(last_->end, end, odometry);
  const auto result = is_measured
                          ? mount_.add({end, &points, odometry.at(end), odometry.turn_confirmed(last_->end, end)})
                          : mount_.skip(end);
  matcher_.set_mount_yaw(mount_.yaw());
  if (result == mounting::MountYaw::Result::kTurned) pairs_.interrupt();
  return result;
}

/// Wheels and gyro, if they agree, outvote a registration. Odometry that leaps is not used for that.
bool Tracker::contradicts_odometry(const Attempt& found, const scan::Scan& scan,
                                   const scan::OdometryHistory& odometry) const {
  if (!config_.turn_by_odometry || !found.believed || !last_->T_odom_base || !odometry.covers(last_->end, scan.end) ||
      !odometry.turn_confirmed(last_->end, scan.end)) {
    return false;
  }
  const Pose T_odom_base = odometry.at(scan.end);
  const scan::Twist by_odometry = scan::twist_of(last_->T_odom_base->inverse() * T_odom_base, stride_);
  const double turn_change = (by_odometry.angular - twist_.angular).norm() * stride_;
  return turn_change < kMaxTurnChange && turns_.contradicts(scan.end, found.fit.result.T_map_base, T_odom_base);
}

/// A refused scan, at the pose that odometry predicts from before the registration began to slide.
Tracker::Attempt Tracker::by_odometry(const scan::Scan& scan, const scan::OdometryHistory& odometry) const {
  Attempt refused{matcher_.predict(departure(), scan, predict_motion(config_, recent(), scan, odometry)),
                  "refused.turn"};
  refused.fit.prior.T_map_base = normalised(turns_.by_odometry(odometry.at(scan.end)));
  return refused;
}

void Tracker::add_faults(std::vector<std::string>& faults) const {
  odometry_check_.add_faults(faults, lidar_yaw_);
  mount_.add_faults(faults);
  if (sparse_in_a_row_ >= kMinSparseForFault)
    faults.push_back(
        fmt::format("LiDAR: fewer than {} returns in each of the last {} revolutions: nothing is mapped, and odometry "
                    "alone tells of the way. Fog, dust, an open field, or a covered window?",
                    config_.min_points, sparse_in_a_row_));
}

}  // namespace curbstone::mapper::tracking
