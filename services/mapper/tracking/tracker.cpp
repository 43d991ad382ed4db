#include "services/mapper/tracking/tracker.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "services/mapper/tracking/levelled.hpp"

namespace curbstone::mapper::tracking {
namespace {

constexpr std::int64_t kMaxSweep = 1'000'000;     // us
constexpr std::int64_t kClockJump = 100'000;      // us backwards: from here on a new clock, not a late scan
constexpr std::int64_t kClockAhead = 60'000'000;  // us between two revolutions in a row: likewise, not a gap
constexpr std::int32_t kInARow = 3;               // revolutions, of which one or two were refused
constexpr int kFirstInsertions = 10;              // scans that the registration map takes even if the vehicle stands
constexpr int kMaxMultiStarts = 3;                // refusals in a row up to which other motions are tried

scan::SharedPoints share(std::vector<scan::LidarPoint> points) {
  return std::make_shared<const std::vector<scan::LidarPoint>>(std::move(points));
}

bool is_sweep(const scan::Scan& scan) {
  return scan.end >= scan.start && scan.end - scan.start <= kMaxSweep;
}

}  // namespace

Tracker::Tracker(const config::TrackerConfig& config, const config::RegistrationConfig& registration,
                 const VehicleConfig& vehicle, bool keeps_map)
    : config_(config),
      keeps_map_(keeps_map),
      matcher_(registration, vehicle, config.max_speed),
      mount_(vehicle.T_base_lidar().translation()),
      turn_by_scans_(vehicle.T_base_lidar().translation()),
      scale_by_scans_(vehicle.T_base_lidar().translation()),
      pairs_(registration, vehicle.T_base_lidar().translation()),
      lidar_yaw_(roll_pitch_yaw(vehicle.T_base_lidar().linear()).z()) {}

std::optional<Tracked> Tracker::track(const scan::Scan& scan, const scan::OdometryHistory& odometry) {
  counters_.add("revolutions");
  if (std::count_if(scan.points.begin(), scan.points.end(), scan::measured) < config_.min_points) {
    counters_.add("refused.sparse");
    ++sparse_in_a_row_;
    return is_sweep(scan) ? process_sparse(scan, odometry) : std::nullopt;
  }
  sparse_in_a_row_ = 0;
  if (!is_sweep(scan)) {
    counters_.add("refused.time");
    return std::nullopt;
  }
  if (!last_) return start(scan, odometry);
  if (!follows(scan, odometry)) {
    counters_.add("refused.time");
    return std::nullopt;
  }

  const scan::OdometryHistory& believed = odometry_check_.rejects_odometry() ? no_odometry_ : odometry;
  Attempt by_scan = attempt(scan, believed);
  const auto T_map_base_by_scan = by_scan.believed ? std::optional(by_scan.fit.result.T_map_base) : std::nullopt;
  Attempt found = with_plausible_turn(std::move(by_scan), scan, odometry, believed);
  if (!found.fit.prediction.with_odometry) counters_.add("without_odometry");
  if (!found.refusal.empty()) counters_.add(found.refusal);
  if (first_ && !found.believed) {  // they do not confirm each other: the drive begins with this one
    forget_start();
    return start(scan, odometry);
  }
  std::optional<Tracked::Earlier> first = confirm_start(found.fit);
  const Last before = *last_;
  Tracked tracked = conclude(scan.end, std::move(found));
  last_number_ = scan.number;
  note_odometry(before, odometry);
  note_turn(tracked, believed);
  tracked.first = std::move(first);
  tracked.T_map_base_by_scan = T_map_base_by_scan;
  if (tracked.maps) insert(*tracked.points, tracked.T_map_base);
  check_odometry(tracked, odometry);
  return tracked;
}

/// The registration, or odometry's pose instead of one that turns otherwise than wheels and gyro.
Tracker::Attempt Tracker::with_plausible_turn(Attempt by_scan, const scan::Scan& scan,
                                              const scan::OdometryHistory& odometry,
                                              const scan::OdometryHistory& believed) {
  const bool is_refused = contradicts_odometry(by_scan, scan, believed);
  Attempt found = is_refused ? by_odometry(scan, odometry) : std::move(by_scan);
  if (is_refused) turn_refused_at_ = scan.end;
  turn_refused_ = is_refused || (turn_refused_ && !found.believed && !turns_.gives_up(scan.end));
  return found;
}

/// Registers the scan from the pose that odometry, or a constant velocity, predicts; if that fails, from other motions.
Tracker::Attempt Tracker::attempt(const scan::Scan& scan, const scan::OdometryHistory& odometry) {
  MotionPrediction prediction = predict_motion(config_, recent(), scan, odometry);
  if (prediction.implausible) counters_.add("odometry.not_believed");
  const PreviousPose from = departure();
  if (prediction.blind) {
    // The first two scans are too far apart to confirm each other: the drive begins with this one.
    if (first_) return {matcher_.predict(from, scan, std::move(prediction)), {}, false};
    if (auto bridged = attempt_across_gap(from, scan, odometry)) return std::move(*bridged);
    tracking_state_.go_blind(counters_);
  }
  if (tracking_state_.unbounded()) return {matcher_.predict(from, scan, std::move(prediction)), {}, false};
  const bool guided = prediction.with_odometry;
  if (first_ && !guided) return judged(matcher_.fit_second(from, *first_, scan));
  if (guided) prediction = corrected(std::move(prediction), scan, odometry);
  Attempt first = judged(matcher_.fit(from, scan, std::move(prediction), motion_));
  if (guided) {
    using Mount = mounting::MountYaw::Result;
    const Mount mount = observe_mount(first.fit.points, scan.end, odometry);
    if (mount == Mount::kUncertain) return {std::move(first.fit), "refused.mount"};
    if (mount == Mount::kTurned)
      first = judged(matcher_.fit(departure(), scan, predict_motion(config_, recent(), scan, odometry), motion_));
  }
  if (first.believed) return guided ? without_leap(std::move(first), from, scan) : first;
  Attempt second = guided ? attempt_without_odometry(from, scan) : attempt_multi_start(from, scan);
  return second.believed ? second : first;
}

/// Registers the scan after seconds of messages were missed, from odometry's poses before and after. Nothing if the
/// LiDAR does not clearly agree.
std::optional<Tracker::Attempt> Tracker::attempt_across_gap(const PreviousPose& from, const scan::Scan& scan,
                                                            const scan::OdometryHistory& odometry) {
  if (!tracking_state_.tracking() || !last_->T_odom_base) return std::nullopt;
  const auto across = predict_across_gap(config_, recent(), *last_->T_odom_base, scan, odometry);
  if (!across) return std::nullopt;
  Attempt bridged = judged(matcher_.fit(from, scan, *across, motion_), Certainty::kGuessed);
  if (!bridged.believed) return std::nullopt;
  counters_.add("bridged");
  return bridged;
}

/// Registers the scan from a constant velocity, in case odometry jumped.
Tracker::Attempt Tracker::attempt_without_odometry(const PreviousPose& from, const scan::Scan& scan) {
  Attempt attempt = judged(matcher_.fit(from, scan, predict_constant_velocity(recent(), scan), motion_));
  if (attempt.believed) counters_.add("odometry.not_believed");
  return attempt;
}

/// Registers the scan from other motions, in case the motion has changed. Costly, so only for kMaxMultiStarts
/// refusals.
Tracker::Attempt Tracker::attempt_multi_start(const PreviousPose& from, const scan::Scan& scan) {
  if (!tracking_state_.tracking() || tracking_state_.refused_in_a_row() >= kMaxMultiStarts) return {};
  return judged(matcher_.fit_multi_start(from, scan, motion_));
}

/// Whether a scan follows the last one in time. A late or duplicate scan does not. After a gap or a jump of the clock
/// the second scan in a row is accepted: a single one may be an error. A clock that was set ahead looks like a gap; but
/// a LiDAR that turned all the time has counted its revolutions on.
bool Tracker::follows(const scan::Scan& scan, const scan::OdometryHistory& odometry) {
  const std::int64_t stride = scan.end - last_->end;
  const bool in_order = stride > 0 && static_cast<double>(stride) * 1e-6 <= kMaxStride;
  const std::optional<std::int64_t> before = std::exchange(broken_, std::nullopt);
  if (in_order || (stride > 0 && odometry.covers(last_->end, scan.end))) return true;
  if (stride <= 0 && stride > -kClockJump) return false;
  const std::int64_t since = before ? scan.end - *before : 0;
  if (since <= 0 || static_cast<double>(since) * 1e-6 > kMaxStride) {
    broken_ = scan.end;
    return false;
  }
  const std::int64_t revolutions = std::int64_t{scan.number} - last_number_;
  const bool is_ahead = stride > kClockAhead && revolutions > 0 && revolutions <= kInARow;
  if (stride < 0 || is_ahead) {  // not a gap but a new clock
    last_->end = *before - std::llround(stride_ * 1e6);
    tracking_state_.start(last_->end);
  }
  return true;
}

/// Sets the new pose, and how far it can be trusted.
Tracked Tracker::conclude(std::int64_t utime, Attempt found) {
  const MotionPrediction& prediction = found.fit.prediction;
  const Pose sought = found.believed ? found.fit.result.T_map_base : found.fit.prior.T_map_base;
  const Pose moved = last_->T_map_base.inverse() * sought;
  const double stride = scan::seconds(last_->end, utime);
  learn_motion(found, moved, stride);

  Tracked tracked;
  tracked.utime = utime;
  tracked.with_odometry = prediction.with_odometry;
  tracked.stationary = prediction.stationary && moved.translation().norm() < 0.03 && angle_of(moved) < 0.01;
  tracked.T_map_base = tracked.stationary ? last_->T_map_base : sought;
  tracked.registration = found.fit.result;
  if (found.believed) {  // registration's covariance does not include errors of de-skew
    tracked.registration.covariance +=
        prediction.with_odometry ? prediction.deskew_covariance : motion_jitter_.covariance();
  }
  last_ = Last{utime, tracked.T_map_base};
  const TrackingState::ScanResult evidence{utime,
                                           stride,
                                           prediction.T_last_base.translation().norm(),
                                           prediction.with_odometry,
                                           found.believed,
                                           prediction.covariance,
                                           found.sparse};
  if (!found.believed) tracked.registration.covariance = tracking_state_.covariance_without(evidence);
  tracked.map_restarted = tracking_state_.judge(evidence, counters_);
  if (tracked.map_restarted) begin_anew();
  tracked.fix = tracking_state_.fix();
  tracked.sparse = found.sparse;
  tracked.registered = found.believed || tracked.map_restarted;
  tracked.maps = tracked.registered && tracking_state_.tracking() && !mount_.shakes();
  tracked.points = share(std::move(found.fit.points));
  return tracked;
}

/// The registration map begins anew at odometry's pose.
void Tracker::begin_anew() {
  matcher_.clear_map();
  turns_.clear();
  turn_refused_ = false;
}

/// Updates the motion: `moved` is the vehicle's motion in `stride` s, by this scan.
void Tracker::learn_motion(const Attempt& found, const Pose& moved, double stride) {
  const bool in_step = stride < kMaxStride;
  if (in_step) {
    stride_ = stride;
    const scan::Twist before = std::exchange(twist_, scan::twist_of(moved, stride));
    if (steady_ >= 2 && found.believed) motion_jitter_.add(before, twist_, stride);
    if (found.fit.prediction.with_odometry) {
      motion_.set(twist_);
    } else if (found.believed) {
      motion_ = found.fit.motion;
    }
  }
  // After a scan that did not fit, or a gap, the difference of two poses does not show the jitter.
  steady_ = found.believed && in_step ? steady_ + 1 : 0;
}

void Tracker::relocate(const Pose& T_map_base) {
  last_->T_map_base = T_map_base;
  steady_ = 0;
  turns_.clear();
  scale_by_scans_.interrupt();
  agreed_.reset();
  tracking_state_.relocate();
}

void Tracker::replace_map(std::unique_ptr<registration::Registration> map, const Pose& T_map_base) {
  matcher_.replace_map(std::move(map));
  last_->T_map_base = T_map_base;
  turns_.clear();
  scale_by_scans_.interrupt();
  T_map_keyframe_ = T_map_base;
  agreed_.reset();
}

void Tracker::begin_at(const Pose& T_map_base, double uncertainty) {
  known_start_ = T_map_base;
  tracking_state_.start_lost(uncertainty);
}

void Tracker::resume(std::int64_t utime, const Pose& T_map_base, double path, const scan::Twist& twist) {
  last_ = Last{utime, T_map_base};
  motion_.set(twist);
  tracking_state_.resume(utime, path);
}

bool Tracker::forget_far() {
  return matcher_.map().keep_around(last_->T_map_base.translation());
}

Tracked Tracker::start(const scan::Scan& scan, const scan::OdometryHistory& odometry) {
  Tracked tracked;
  tracked.began = true;
  tracked.utime = scan.end;
  tracked.with_odometry = odometry.covers(scan.start, scan.end);
  const scan::SweepMotion sweep = tracked.with_odometry ? scan::sweep_from(odometry, scan.start, scan.end)
                                                        : scan::steady_sweep({}, scan::seconds(scan.start, scan.end));
  if (!tracked.with_odometry) counters_.add("without_odometry");
  if (tracked.with_odometry) tracked.T_map_base = levelled(odometry.at(scan.end));
  if (known_start_) tracked.T_map_base = *known_start_ * tracked.T_map_base;
  tracked.fix = tracking_state_.fix();
  tracked.registered = tracking_state_.tracking();
  tracked.registration.T_map_base = tracked.T_map_base;
  tracked.registration.converged = true;
  tracked.registration.inlier_ratio = 1;
  last_ = Last{scan.end, tracked.T_map_base};
  last_number_ = scan.number;
  tracking_state_.start(scan.end);
  T_map_keyframe_ = tracked.T_map_base;
  if (tracked.registered && !tracked.with_odometry) {
    first_ = scan;
    first_points_ = matcher_.in_base(scan, sweep);
    matcher_.map().insert(first_points_, tracked.T_map_base);
    tracked.points = share({});
    return tracked;
  }
  tracked.points = share(matcher_.in_base(scan, sweep));
  tracked.maps = tracked.registered;
  if (tracked.maps) insert(*tracked.points, tracked.T_map_base);
  return tracked;
}

/// The second scan fits the first, which confirms it: returns the first scan for the map. Nothing for all later scans.
std::optional<Tracked::Earlier> Tracker::confirm_start(const Fit& second) {
  if (!std::exchange(first_, std::nullopt)) return std::nullopt;
  std::vector<scan::LidarPoint> points = std::exchange(first_points_, {});
  if (!second.first_points.empty()) points = second.first_points;
  return Tracked::Earlier{share(std::move(points)), last_->T_map_base, last_->end};
}

void Tracker::forget_start() {
  matcher_.clear_map();
  last_.reset();
  turns_.clear();
  scale_by_scans_.interrupt();
  tracking_state_.forget_drift();
  twist_ = {};
  motion_.set({});
  first_.reset();
  first_points_.clear();
}

Certainty Tracker::certainty() const {
  if (tracking_state_.tracking()) return Certainty::kFollowed;
  return tracking_state_.fix() == Fix::kTentative ? Certainty::kFound : Certainty::kGuessed;
}

Tracker::Attempt Tracker::judged(Fit fit, Certainty guess) const {
  Attempt attempt{std::move(fit), {}, false};
  attempt.refusal = why_refused(attempt.fit, config_, tracking_state_.drift(), guess);
  attempt.believed = attempt.refusal.empty();
  return attempt;
}

void Tracker::insert(const std::vector<scan::LidarPoint>& points, const Pose& T_map_base) {
  if (!keeps_map_) return;
  const Pose since_keyframe = T_map_keyframe_.inverse() * T_map_base;
  if (counters_["keyframes"] >= kFirstInsertions && since_keyframe.translation().norm() <= config_.keyframe_m &&
      angle_of(since_keyframe) <= config_.keyframe_rad) {
    return;
  }
  counters_.add("keyframes");
  T_map_keyframe_ = T_map_base;
  matcher_.map().insert(points, T_map_base);
}

}  // namespace curbstone::mapper::tracking
