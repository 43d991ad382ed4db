#include "services/mapper/tracker.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "services/mapper/make_registration.hpp"

namespace curbstone {
namespace {

constexpr std::int64_t kLongestSweep = 1'000'000;  // us
constexpr std::int64_t kClockJump = 1'000'000;     // us backwards that is a new clock, not a late revolution
constexpr int kDeskewPasses = 2;                   // without odometry
constexpr double kRefined = 0.15;                  // m, that such a pass may find its points off
constexpr double kLever = 15.0;                    // m, at which most of what is registered stands
constexpr int kFirstInsertions = 10;               // revolutions that go into the map even when the vehicle stands
constexpr std::int64_t kPatience = 1'000'000;      // us without a fit, after which the pose is lost
constexpr int kConfirmed = 10;                     // revolutions in a row that must fit before a pose is trusted again
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

Tracker::Tracker(const MapperConfig& config)
    : config_(config), T_base_lidar_(config.vehicle.T_base_lidar()), registration_(make_registration(config)) {}

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

  const MotionExpectation expected = expect_motion(config_, recent(), revolution, odometry);
  if (expected.incredible) counters_.add("odometry.not_believed");
  if (expected.blind && fix_ != Fix::kLost) {
    counters_.add("lost.blind");
    fix_ = Fix::kLost;
  }
  blind_ = blind_ || expected.blind;
  const bool searching = fix_ == Fix::kLost && blind_;  // a registration from a mere guess fits somewhere, only where?
  Attempt attempt = searching ? attempt_from(revolution, expected) : try_with(revolution, expected);
  if (!searching && !attempt.believed && expected.with_odometry) {
    // Perhaps it is odometry that jumped.
    Attempt second = try_with(revolution, expect_steady(recent(), revolution));
    if (second.believed) {
      counters_.add("odometry.not_believed");
      attempt = std::move(second);
    }
  }
  Tracked tracked;
  tracked.utime = revolution.end;
  tracked.registration = attempt.result;
  tracked.registered = attempt.believed;
  tracked.with_odometry = attempt.expected.with_odometry;
  if (!tracked.with_odometry) counters_.add("without_odometry");
  if (!tracked.registered && !attempt.refusal.empty()) counters_.add(attempt.refusal);
  if (first_ && !finish_start(tracked)) return start(revolution, odometry);
  conclude(attempt, tracked);
  tracked.points = std::move(attempt.points);
  if (tracked.maps) insert(tracked);
  return tracked;
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
void Tracker::conclude(const Attempt& attempt, Tracked& tracked) {
  tracked.T_map_base = tracked.registered ? attempt.result.T_map_base : attempt.prior.T_map_base;
  const Pose moved = last_->T_map_base.inverse() * tracked.T_map_base;
  tracked.stationary = attempt.expected.stationary && moved.translation().norm() < 0.03 && angle_of(moved) < 0.01;
  if (tracked.stationary) tracked.T_map_base = last_->T_map_base;
  const double stride = seconds(last_->end, tracked.utime);
  if (stride < kLongestStride) {
    const Twist before = std::exchange(twist_, twist_of(moved, stride));
    stride_ = stride;
    if (steady_ >= 2 && tracked.registered) unsteadiness_.add(before, twist_, stride);
  }
  // An earlier pose that did not fit, or is another's, tells nothing of this one's error.
  steady_ = tracked.registered && stride < kLongestStride ? steady_ + 1 : 0;
  if (tracked.registered && !attempt.expected.with_odometry)
    tracked.registration.covariance += unsteadiness_.covariance();
  last_ = Last{tracked.utime, tracked.T_map_base};
  const double went = attempt.expected.T_last_base.translation().norm();
  since_fitted_m_ += went;
  const bool guided = attempt.expected.with_odometry && fix_ != Fix::kLost;
  doubt_ += guided ? kGuidedDoubt * went : kDoubtSpeed * stride;
  judge(attempt, tracked);
}

void Tracker::judge(const Attempt& attempt, Tracked& tracked) {
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
    drift_ += attempt.expected.covariance;
    if (fix_ == Fix::kTentative) fix_ = Fix::kLost;
    if (fix_ == Fix::kTracking && tracked.utime - fitted_ > kPatience) {
      counters_.add("lost.refused");
      fix_ = Fix::kLost;
      blind_ = !attempt.expected.with_odometry;
    }
  }
  if (fix_ == Fix::kTracking && tracked.registered) {
    fitted_ = tracked.utime;
    since_fitted_m_ = doubt_ = 0;
    blind_ = false;
  }
  if (may_begin_anew(attempt, tracked)) {
    counters_.add("began_anew");
    registration_ = make_registration(config_);
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
bool Tracker::may_begin_anew(const Attempt& attempt, const Tracked& tracked) const {
  return fix_ == Fix::kLost && !blind_ && attempt.expected.with_odometry && !tracked.registered &&
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
  registration_ = make_registration(config_);
  for (const MapNode* node : nodes) registration_->recall(*node);
  (void)registration_->keep_around(T_map_base.translation());
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
  return registration_->keep_around(last_->T_map_base.translation());
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
    begin_registration_map({});
    return tracked;
  }
  tracked.points = in_base(revolution, sweep);
  tracked.maps = tracked.registered;
  if (tracked.maps) insert(tracked);
  return tracked;
}

/// The revolution as it is expected to lie, not registered yet.
Tracker::Attempt Tracker::attempt_from(const Revolution& revolution, MotionExpectation expected) const {
  Attempt attempt;
  attempt.prior.T_map_base = normalised(last_->T_map_base * expected.T_last_base);
  const Matrix6 covariance = drift_ + expected.covariance;
  attempt.prior.information = covariance.inverse();
  attempt.prior.reach = 3 * (std::sqrt(covariance(0, 0)) + kLever * std::sqrt(covariance(3, 3)));
  attempt.expected = std::move(expected);
  attempt.points = in_base(revolution, attempt.expected.sweep);
  return attempt;
}

Tracker::Attempt Tracker::try_with(const Revolution& revolution, MotionExpectation expected) {
  Attempt attempt = attempt_from(revolution, std::move(expected));
  align(revolution, attempt);
  attempt.refusal = refusal(attempt);
  attempt.believed = attempt.refusal.empty();
  return attempt;
}

std::vector<LidarPoint> Tracker::in_base(const Revolution& revolution, const SweepMotion& sweep) const {
  std::vector<LidarPoint> points = deskew(revolution.points, T_base_lidar_, sweep);
  const Eigen::Vector3f half(static_cast<float>(config_.vehicle.length) / 2 + 0.1F,
                             static_cast<float>(config_.vehicle.width) / 2 + 0.1F, 0);
  const float top = static_cast<float>(config_.vehicle.height) + 0.1F;
  std::erase_if(points, [&](const LidarPoint& p) {  // the vehicle sees itself
    return std::abs(p.position.x()) < half.x() && std::abs(p.position.y()) < half.y() && p.position.z() > 0.1F &&
           p.position.z() < top;
  });
  return points;
}

/// Registers; where no odometry says how the vehicle moved during the revolution, the answer itself says it better than
/// the expectation did, so de-skew and register again. Not until both agree: on a young map the two can chase each
/// other.
void Tracker::align(const Revolution& revolution, Attempt& attempt) {
  attempt.result = registration_->align(attempt.points, attempt.prior);
  const double stride = seconds(last_->end, revolution.end);
  if (attempt.expected.with_odometry || stride > kLongestStride) return;
  const double sweep_seconds = seconds(revolution.start, revolution.end);
  Twist assumed = twist_;
  PosePrior prior = attempt.prior;
  for (int pass = 0; pass < kDeskewPasses && attempt.result.converged; ++pass) {
    const Twist found = twist_of(last_->T_map_base.inverse() * attempt.result.T_map_base, stride);
    if ((found.linear - assumed.linear).norm() * sweep_seconds < 0.01 &&
        (found.angular - assumed.angular).norm() * sweep_seconds < 1e-3) {
      break;
    }
    assumed = found;
    attempt.points = in_base(revolution, steady_sweep(assumed, sweep_seconds));
    prior.T_map_base = attempt.result.T_map_base;
    prior.reach = kRefined;
    if (first_) begin_registration_map(assumed);
    attempt.result = registration_->align(attempt.points, prior);
  }
}

/// The second revolution tells whether the first was any good: if it fits, the first goes into the map, else it is
/// forgotten and the second becomes the first.
bool Tracker::finish_start(Tracked& tracked) {
  if (tracked.registered) {
    tracked.first = Tracked::Earlier{std::move(first_points_), last_->T_map_base, last_->end};
  } else {
    registration_ = make_registration(config_);
    last_.reset();
    drift_.setZero();
    twist_ = {};
  }
  first_.reset();
  first_points_.clear();
  return tracked.registered;
}

/// The first revolution again, now that its motion is known.
void Tracker::begin_registration_map(const Twist& twist) {
  first_points_ = in_base(*first_, steady_sweep(twist, seconds(first_->start, first_->end)));
  registration_ = make_registration(config_);
  registration_->insert(first_points_, last_->T_map_base);
}

/// Why an answer is not believed; empty if it is.
std::string Tracker::refusal(const Attempt& attempt) const {
  const RegistrationResult& result = attempt.result;
  if (!result.converged) return "refused.not_converged";
  if (result.overlap < config_.min_overlap) return "refused.overlap";
  if (result.inlier_ratio < config_.min_inliers) return "refused.inliers";
  if (result.residual > config_.max_residual) return "refused.residual";
  if (fix_ != Fix::kTracking) {  // the ground alone fits everywhere
    if (result.overlap < kFirmOverlap) return "refused.overlap";
    if (result.inlier_ratio < kFirmInliers || (result.degenerate & kPlanarAxes) != 0) return "refused.inliers";
  }
  const Pose jump = attempt.prior.T_map_base.inverse() * result.T_map_base;
  const Matrix6 covariance = drift_ + attempt.expected.covariance;
  const bool guided = attempt.expected.with_odometry;
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
  registration_->insert(tracked.points, tracked.T_map_base);
}

}  // namespace curbstone
