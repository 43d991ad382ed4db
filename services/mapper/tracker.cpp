#include "services/mapper/tracker.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace curbstone {
namespace {

constexpr std::int64_t kLongestSweep = 1'000'000;  // us
constexpr std::int64_t kClockJump = 1'000'000;     // us backwards that is a new clock, not a late revolution
constexpr int kFirstInsertions = 10;               // revolutions that go into the map even when the vehicle stands
constexpr std::int64_t kPatience = 1'000'000;      // us without a fit, after which the pose is lost
constexpr int kConfirmed = 10;                     // revolutions in a row that must fit before a pose is trusted again
constexpr int kMostFromAfar = 3;                   // refused in a row that are sought with other motions
constexpr double kFirmOverlap = 0.4;               // what a revolution must show to be believed while the pose is not
constexpr double kFirmInliers = 0.75;
constexpr double kDoubtSpeed = 3.0;             // m/s, how doubt grows while lost or when nothing tells of the motion,
constexpr double kGuidedDoubt = 0.05;           // and m a metre when odometry does
constexpr std::int64_t kNewGround = 6'000'000;  // us, by when it has been sought everywhere, and
constexpr double kNewGroundPath = 10.0;         // m by odometry, without a fit: these surroundings are new

/// Gravity's share of an attitude: roll and pitch, without yaw.
Pose levelled(const Pose& T_odom_base) {
  const Eigen::Vector3d rpy = roll_pitch_yaw(T_odom_base.linear());
  Pose T = Pose::Identity();
  T.linear() = rotation_from_rpy(rpy.x(), rpy.y(), 0);
  return T;
}

}  // namespace

Tracker::Tracker(const MapperConfig& config) : config_(config), fitter_(config) {}

std::optional<Tracked> Tracker::track(const Revolution& revolution, const OdometryHistory& odometry) {
  counters_.add("revolutions");
  if (std::count_if(revolution.points.begin(), revolution.points.end(), measured) < config_.min_points) {
    counters_.add("refused.sparse");
    return std::nullopt;
  }
  if (revolution.end < revolution.start || revolution.end - revolution.start > kLongestSweep) {
    counters_.add("refused.time");
    return std::nullopt;
  }
  if (!last_) return start(revolution, odometry);
  if (!follows(revolution, odometry)) {
    counters_.add("refused.time");
    return std::nullopt;
  }

  Attempt found = attempt(revolution, odometry);
  Tracked tracked;
  tracked.utime = revolution.end;
  tracked.registration = found.fit.result;
  tracked.registered = found.believed;
  tracked.with_odometry = found.fit.expected.with_odometry;
  if (!tracked.with_odometry) counters_.add("without_odometry");
  if (!tracked.registered && !found.refusal.empty()) counters_.add(found.refusal);
  if (first_ && !finish_start(tracked)) return start(revolution, odometry);
  conclude(found.fit, tracked);
  tracked.points = std::move(found.fit.points);
  if (tracked.maps) insert(tracked);
  return tracked;
}

/// Where the revolution is, by all that may tell.
Tracker::Attempt Tracker::attempt(const Revolution& revolution, const OdometryHistory& odometry) {
  MotionExpectation expected = expect_motion(config_, recent(), revolution, odometry);
  if (expected.incredible) counters_.add("odometry.not_believed");
  const Departure from = departure();
  if (expected.blind && first_) {  // too far apart to tell of each other: the drive begins with this one
    return {fitter_.expect(from, revolution, std::move(expected)), {}, false};
  }
  if (expected.blind && fix_ != Fix::kLost) {
    counters_.add("lost.blind");
    fix_ = Fix::kLost;
  }
  blind_ = blind_ || expected.blind;
  if (fix_ == Fix::kLost && blind_) {  // a registration from a mere guess fits somewhere, only where?
    return {fitter_.expect(from, revolution, std::move(expected)), {}, false};
  }
  const bool guided = expected.with_odometry;
  if (first_ && !guided) return judged(fitter_.fit_second(from, *first_, revolution, first_points_));
  Attempt first = judged(fitter_.fit(from, revolution, std::move(expected), motion_));
  if (first.believed) return first;
  if (guided) {  // perhaps it is odometry that jumped
    Attempt second = judged(fitter_.fit(from, revolution, expect_steady(recent(), revolution), motion_));
    if (!second.believed) return first;
    counters_.add("odometry.not_believed");
    return second;
  }
  if (fix_ != Fix::kTracking || refused_in_a_row_ >= kMostFromAfar) return first;
  Attempt second = judged(fitter_.fit_from_afar(from, revolution, motion_));
  return second.believed ? second : first;
}

/// Whether a revolution comes after the last one, as time goes. What is late or comes once more does not. After a
/// break, a gap or a clock that jumped, the second in a row is believed: one alone may be an error.
bool Tracker::follows(const Revolution& revolution, const OdometryHistory& odometry) {
  const std::int64_t stride = revolution.end - last_->end;
  const bool in_order = stride > 0 && static_cast<double>(stride) * 1e-6 <= kLongestStride;
  const std::optional<std::int64_t> before = std::exchange(broken_, std::nullopt);
  if (in_order || (stride > 0 && odometry.covers(last_->end, revolution.end))) return true;
  if (stride <= 0 && stride > -kClockJump) return false;
  const std::int64_t since = before ? revolution.end - *before : 0;
  if (since <= 0 || static_cast<double>(since) * 1e-6 > kLongestStride) {
    broken_ = revolution.end;
    return false;
  }
  if (stride < 0) last_->end = fitted_ = *before - std::llround(stride_ * 1e6);  // no gap: a new clock
  return true;
}

/// The new pose is settled, and with it how far it can be trusted.
void Tracker::conclude(const Fit& fit, Tracked& tracked) {
  tracked.T_map_base = tracked.registered ? fit.result.T_map_base : fit.prior.T_map_base;
  const Pose moved = last_->T_map_base.inverse() * tracked.T_map_base;
  tracked.stationary = fit.expected.stationary && moved.translation().norm() < 0.03 && angle_of(moved) < 0.01;
  if (tracked.stationary) tracked.T_map_base = last_->T_map_base;
  learn_motion(fit, tracked, moved);
  if (tracked.registered) {  // registration itself knows nothing of what de-skew got wrong
    tracked.registration.covariance +=
        fit.expected.with_odometry ? fit.expected.deskew_covariance : unsteadiness_.covariance();
  }
  const double stride = seconds(last_->end, tracked.utime);
  last_ = Last{tracked.utime, tracked.T_map_base};
  const double went = fit.expected.T_last_base.translation().norm();
  since_fitted_m_ += went;
  const bool guided = fit.expected.with_odometry && fix_ != Fix::kLost;
  doubt_ += guided ? kGuidedDoubt * went : kDoubtSpeed * stride;
  judge(fit, tracked);
}

/// What the revolution tells of the motion.
void Tracker::learn_motion(const Fit& fit, const Tracked& tracked, const Pose& moved) {
  const double stride = seconds(last_->end, tracked.utime);
  const bool in_step = stride < kLongestStride;
  if (in_step) {
    stride_ = stride;
    const Twist before = std::exchange(twist_, twist_of(moved, stride));
    if (steady_ >= 2 && tracked.registered) unsteadiness_.add(before, twist_, stride);
    if (fit.expected.with_odometry) {
      motion_.set(twist_);
    } else if (tracked.registered) {
      motion_ = fit.motion;
    }
  }
  // An earlier pose that did not fit, or is another's, tells nothing of this one's error.
  steady_ = tracked.registered && in_step ? steady_ + 1 : 0;
}

void Tracker::judge(const Fit& fit, Tracked& tracked) {
  if (tracked.registered) {
    refused_in_a_row_ = 0;
    drift_.setZero();
    if (fix_ == Fix::kLost) {
      fix_ = Fix::kTentative;
      fitting_ = 0;
    }
    if (fix_ == Fix::kTentative && ++fitting_ >= kConfirmed) {
      counters_.add("found");
      fix_ = Fix::kTracking;
    }
  } else {
    ++refused_in_a_row_;
    drift_ += fit.expected.covariance;
    if (fix_ == Fix::kTentative) fix_ = Fix::kLost;
    if (fix_ == Fix::kTracking && tracked.utime - fitted_ > kPatience) {
      counters_.add("lost.refused");
      fix_ = Fix::kLost;
      blind_ = !fit.expected.with_odometry;
    }
  }
  if (fix_ == Fix::kTracking && tracked.registered) {
    fitted_ = tracked.utime;
    since_fitted_m_ = doubt_ = 0;
    blind_ = false;
  }
  if (may_begin_anew(fit, tracked)) {
    counters_.add("began_anew");
    fitter_.clear_map();
    fix_ = Fix::kTracking;
    drift_.setZero();
    since_fitted_m_ = doubt_ = 0;
    fitted_ = tracked.utime;
    tracked.anew = tracked.registered = true;
  }
  tracked.fix = fix_;
  tracked.maps = tracked.registered && fix_ == Fix::kTracking;
}

/// Lost, but odometry held all the while and the vehicle has driven on: what it sees is new, not displaced. Who was
/// lifted and put down elsewhere has not driven.
bool Tracker::may_begin_anew(const Fit& fit, const Tracked& tracked) const {
  return fix_ == Fix::kLost && !blind_ && fit.expected.with_odometry && !tracked.registered &&
         tracked.utime - fitted_ > kNewGround && since_fitted_m_ > kNewGroundPath;
}

void Tracker::relocate(const Pose& T_map_base) {
  last_->T_map_base = T_map_base;
  steady_ = 0;
  drift_.setZero();
  fix_ = Fix::kTentative;
  fitting_ = 0;
  blind_ = false;
}

void Tracker::rebuild(const std::vector<const MapNode*>& nodes, const Pose& T_map_base) {
  fitter_.clear_map();
  for (const MapNode* node : nodes) fitter_.map().recall(*node);
  (void)fitter_.map().keep_around(T_map_base.translation());
  last_->T_map_base = T_map_base;
  T_map_keyframe_ = T_map_base;
}

void Tracker::begin_at(const Pose& T_map_base, double doubt) {
  known_start_ = T_map_base;
  fix_ = Fix::kLost;
  blind_ = true;
  doubt_ = doubt;
}

bool Tracker::forget_far() {
  return fitter_.map().keep_around(last_->T_map_base.translation());
}

Tracked Tracker::start(const Revolution& revolution, const OdometryHistory& odometry) {
  Tracked tracked;
  tracked.began = true;
  tracked.utime = revolution.end;
  tracked.with_odometry = odometry.covers(revolution.start, revolution.end);
  const SweepMotion sweep = tracked.with_odometry ? sweep_from(odometry, revolution.start, revolution.end)
                                                  : steady_sweep({}, seconds(revolution.start, revolution.end));
  if (!tracked.with_odometry) counters_.add("without_odometry");
  if (tracked.with_odometry) tracked.T_map_base = levelled(odometry.at(revolution.end));
  if (known_start_) tracked.T_map_base = *known_start_ * tracked.T_map_base;
  tracked.fix = fix_;
  tracked.registered = fix_ == Fix::kTracking;
  tracked.registration.T_map_base = tracked.T_map_base;
  tracked.registration.converged = true;
  tracked.registration.inlier_ratio = 1;
  last_ = Last{revolution.end, tracked.T_map_base};
  fitted_ = revolution.end;
  T_map_keyframe_ = tracked.T_map_base;
  if (tracked.registered && !tracked.with_odometry) {
    first_ = revolution;
    first_points_ = fitter_.in_base(revolution, sweep);
    fitter_.map().insert(first_points_, tracked.T_map_base);
    return tracked;
  }
  tracked.points = fitter_.in_base(revolution, sweep);
  tracked.maps = tracked.registered;
  if (tracked.maps) insert(tracked);
  return tracked;
}

/// The second revolution tells whether the first was any good: if it fits, the first goes into the map, else it is
/// forgotten and the second becomes the first.
bool Tracker::finish_start(Tracked& tracked) {
  if (tracked.registered) {
    tracked.first = Tracked::Earlier{std::move(first_points_), last_->T_map_base, last_->end};
  } else {
    fitter_.clear_map();
    last_.reset();
    drift_.setZero();
    twist_ = {};
    motion_.set({});
  }
  first_.reset();
  first_points_.clear();
  return tracked.registered;
}

Tracker::Attempt Tracker::judged(Fit fit) const {
  Attempt attempt{std::move(fit), {}, false};
  attempt.refusal = refusal(attempt.fit);
  attempt.believed = attempt.refusal.empty();
  return attempt;
}

/// Why an answer is not believed; empty if it is.
std::string Tracker::refusal(const Fit& fit) const {
  const RegistrationResult& result = fit.result;
  if (!result.converged) return "refused.not_converged";
  if (result.overlap < config_.min_overlap) return "refused.overlap";
  if (result.inlier_ratio < config_.min_inliers) return "refused.inliers";
  if (result.residual > config_.max_residual) return "refused.residual";
  if (fix_ != Fix::kTracking) {  // the ground alone fits everywhere
    if (result.overlap < kFirmOverlap) return "refused.overlap";
    if (result.inlier_ratio < kFirmInliers || (result.degenerate & kPlanarAxes) != 0) return "refused.inliers";
  }
  const Pose jump = fit.prior.T_map_base.inverse() * result.T_map_base;
  const Matrix6 covariance = drift_ + fit.expected.covariance;
  const bool guided = fit.expected.with_odometry;
  const double max_m = (guided ? config_.max_jump_m : 0) + 3 * std::sqrt(covariance(0, 0));
  const double max_rad = (guided ? config_.max_jump_rad : 0) + 3 * std::sqrt(covariance(3, 3));
  if (jump.translation().norm() > max_m || angle_of(jump) > max_rad) return "refused.jump";
  return {};
}

void Tracker::insert(const Tracked& tracked) {
  if (config_.mode == "localise") return;
  const Pose since_keyframe = T_map_keyframe_.inverse() * tracked.T_map_base;
  if (counters_["keyframes"] >= kFirstInsertions && since_keyframe.translation().norm() <= config_.keyframe_m &&
      angle_of(since_keyframe) <= config_.keyframe_rad) {
    return;
  }
  counters_.add("keyframes");
  T_map_keyframe_ = tracked.T_map_base;
  fitter_.map().insert(tracked.points, tracked.T_map_base);
}

}  // namespace curbstone
