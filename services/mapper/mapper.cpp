#include "services/mapper/mapper.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "services/mapper/make_registration.hpp"

namespace curbstone {
namespace {

constexpr double kLongestStride = 1.0;             // s: after that, a constant velocity is no expectation any more
constexpr std::int64_t kLongestSweep = 1'000'000;  // us
constexpr std::int64_t kClockJump = 1'000'000;     // us backwards that is a new clock, not a late revolution
constexpr double kAcceleration = 10.0;  // m/s a revolution's time, what velocity may be off by without odometry
constexpr double kTurning = 2.0;        // rad/s, the same for rotation
constexpr int kDeskewPasses = 2;        // without odometry
constexpr double kRefined = 0.15;       // m, that such a pass may find its points off
constexpr double kLever = 15.0;         // m, at which most of what is registered stands
constexpr std::size_t kMostHeld = 20;   // revolutions of the first standstill: more show nothing new
constexpr int kFirstInsertions = 10;    // revolutions that go into the map even when the vehicle stands

double seconds(std::int64_t from, std::int64_t to) {
  return static_cast<double>(to - from) * 1e-6;
}

double angle_of(const Pose& motion) {
  return so3_log(Eigen::Quaterniond(motion.linear())).norm();
}

/// Gravity's share of an attitude: roll and pitch, without yaw.
Pose levelled(const Pose& T_odom_base) {
  const Eigen::Vector3d rpy = roll_pitch_yaw(T_odom_base.linear());
  Pose T = Pose::Identity();
  T.linear() = rotation_from_rpy(rpy.x(), rpy.y(), 0);
  return T;
}

Matrix6 isotropic(double translation, double rotation) {
  Vector6 diagonal;
  diagonal << Eigen::Vector3d::Constant(translation * translation), Eigen::Vector3d::Constant(rotation * rotation);
  return diagonal.asDiagonal();
}

}  // namespace

Mapper::Mapper(const MapperConfig& config)
    : config_(config),
      T_base_lidar_(config.vehicle.T_base_lidar()),
      registration_(make_registration(config)),
      dense_(config.dense) {}

std::optional<MapperUpdate> Mapper::process(const Revolution& revolution, const OdometryHistory& odometry) {
  counters_.add("revolutions");
  if (std::count_if(revolution.points.begin(), revolution.points.end(), measured) < config_.min_points) {
    counters_.add("refused.sparse");
    return std::nullopt;
  }
  if (revolution.end < revolution.start || revolution.end - revolution.start > kLongestSweep) {
    counters_.add("refused.time");
    return std::nullopt;
  }
  if (last_ && revolution.end <= last_->end) {
    counters_.add("refused.time");  // once more, or late; or the clock went back: then its new time counts from here on
    if (last_->end - revolution.end > kClockJump) last_->end = revolution.end;
    return std::nullopt;
  }
  MapperUpdate update;
  update.utime = revolution.end;
  update.revolution = revolution.number;
  if (!last_) {
    start(revolution, odometry, update);
    return update;
  }

  Attempt attempt = try_with(revolution, expect(revolution, odometry));
  if (!attempt.believed && attempt.expected.with_odometry) {
    // Perhaps it is odometry that jumped.
    Attempt second = try_with(revolution, expect_steady(revolution));
    if (second.believed) {
      counters_.add("odometry.not_believed");
      attempt = std::move(second);
    }
  }
  update.registration = attempt.result;
  update.registered = attempt.believed;
  update.with_odometry = attempt.expected.with_odometry;
  if (!update.with_odometry) counters_.add("without_odometry");
  if (!update.registered) counters_.add(attempt.refusal);
  if (first_ && !finish_start(update)) {
    start(revolution, odometry, update);
    return update;
  }
  conclude(revolution, odometry, attempt, update);
  return update;
}

/// The new pose is settled: remembers it, and adds the revolution to the map if it fits.
void Mapper::conclude(const Revolution& revolution, const OdometryHistory& odometry, const Attempt& attempt,
                      MapperUpdate& update) {
  update.T_map_base = update.registered ? attempt.result.T_map_base : attempt.prior.T_map_base;
  const Pose moved = last_->T_map_base.inverse() * update.T_map_base;
  update.stationary = attempt.expected.stationary && moved.translation().norm() < 0.03 && angle_of(moved) < 0.01;
  if (update.stationary) update.T_map_base = last_->T_map_base;
  if (odometry.covers(revolution.end, revolution.end)) {
    T_map_odom_ = normalised(update.T_map_base * odometry.at(revolution.end).inverse());
  }
  update.T_map_odom = T_map_odom_;
  const double stride = seconds(last_->end, revolution.end);
  if (stride < kLongestStride) {
    twist_ = twist_of(moved, stride);
    stride_ = stride;
  }
  last_ = Last{revolution.end, update.T_map_base};
  if (update.registered) {
    refused_in_a_row_ = 0;
    drift_.setZero();
    insert(attempt.points, update);
  } else {
    ++refused_in_a_row_;
    drift_ += attempt.expected.covariance;
  }
}

void Mapper::start(const Revolution& revolution, const OdometryHistory& odometry, MapperUpdate& update) {
  update.with_odometry = odometry.covers(revolution.start, revolution.end);
  const SweepMotion sweep = update.with_odometry ? sweep_from(odometry, revolution.start, revolution.end)
                                                 : steady_sweep({}, seconds(revolution.start, revolution.end));
  if (update.with_odometry) {
    const Pose T_odom_base = odometry.at(revolution.end);
    update.T_map_base = levelled(T_odom_base);
    T_map_odom_ = normalised(update.T_map_base * T_odom_base.inverse());
  } else {
    counters_.add("without_odometry");
    first_ = revolution;
  }
  update.T_map_odom = T_map_odom_;
  update.registered = true;
  update.registration.T_map_base = update.T_map_base;
  update.registration.converged = true;
  update.registration.inlier_ratio = 1;
  last_ = Last{revolution.end, update.T_map_base};
  moved_ = started_ = revolution.end;
  T_map_moved_ = T_map_keyframe_ = update.T_map_base;
  if (first_) {
    begin_registration_map({});
  } else {
    insert(in_base(revolution, sweep), update);
  }
}

Mapper::Expectation Mapper::expect(const Revolution& revolution, const OdometryHistory& odometry) {
  const std::int64_t from = std::min(last_->end, revolution.start);
  if (!odometry.covers(from, revolution.end)) return expect_steady(revolution);
  Expectation expected;
  expected.with_odometry = true;
  expected.T_last_base = odometry.at(last_->end).inverse() * odometry.at(revolution.end);
  const double stride = std::max(seconds(last_->end, revolution.end), 0.02);
  if (expected.T_last_base.translation().norm() > config_.max_speed * stride ||
      angle_of(expected.T_last_base) > config_.max_turn * stride) {
    counters_.add("odometry.not_believed");  // no vehicle moves like that: the filter began again, or jumped
    return expect_steady(revolution);
  }
  expected.stationary = odometry.stationary(from, revolution.end);
  expected.sweep = sweep_from(odometry, revolution.start, revolution.end);
  expected.covariance =
      isotropic(config_.prior_floor_m + config_.prior_translation * expected.T_last_base.translation().norm(),
                config_.prior_floor_rad + config_.prior_rotation * angle_of(expected.T_last_base));
  return expected;
}

Mapper::Expectation Mapper::expect_steady(const Revolution& revolution) const {
  double stride = seconds(last_->end, revolution.end);
  if (stride > kLongestStride) stride = stride_;  // a new clock: the vehicle hardly waited for it
  Expectation expected;
  expected.T_last_base = move(twist_, stride);
  expected.sweep = steady_sweep(twist_, seconds(revolution.start, revolution.end));
  expected.covariance = isotropic(kAcceleration * std::max(stride, 0.05), kTurning * std::max(stride, 0.05));
  return expected;
}

Mapper::Attempt Mapper::try_with(const Revolution& revolution, Expectation expected) {
  Attempt attempt;
  attempt.prior.T_map_base = normalised(last_->T_map_base * expected.T_last_base);
  const Matrix6 covariance = drift_ + expected.covariance;
  attempt.prior.information = covariance.inverse();
  attempt.prior.reach = 3 * (std::sqrt(covariance(0, 0)) + kLever * std::sqrt(covariance(3, 3)));
  attempt.expected = std::move(expected);
  align(revolution, attempt);
  attempt.refusal = refusal(attempt);
  attempt.believed = attempt.refusal.empty();
  return attempt;
}

std::vector<LidarPoint> Mapper::in_base(const Revolution& revolution, const SweepMotion& sweep) const {
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
void Mapper::align(const Revolution& revolution, Attempt& attempt) {
  attempt.points = in_base(revolution, attempt.expected.sweep);
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
bool Mapper::finish_start(MapperUpdate& update) {
  if (update.registered) {
    update.grown = dense_.insert(first_points_, last_->T_map_base, last_->end);
  } else {
    registration_ = make_registration(config_);
    last_.reset();
    drift_.setZero();
    twist_ = {};
  }
  first_.reset();
  first_points_.clear();
  return update.registered;
}

/// The first revolution again, now that its motion is known.
void Mapper::begin_registration_map(const Twist& twist) {
  first_points_ = in_base(*first_, steady_sweep(twist, seconds(first_->start, first_->end)));
  registration_ = make_registration(config_);
  registration_->insert(first_points_, last_->T_map_base);
}

/// Why an answer is not believed; empty if it is.
std::string Mapper::refusal(const Attempt& attempt) const {
  const RegistrationResult& result = attempt.result;
  if (!result.converged) return "refused.not_converged";
  if (result.overlap < config_.min_overlap) return "refused.overlap";
  if (result.inlier_ratio < config_.min_inliers) return "refused.inliers";
  if (result.residual > config_.max_residual) return "refused.residual";
  const Pose jump = attempt.prior.T_map_base.inverse() * result.T_map_base;
  const Matrix6 covariance = drift_ + attempt.expected.covariance;
  const bool guided = attempt.expected.with_odometry;
  const double max_m = (guided ? config_.max_jump_m : 0) + 3 * std::sqrt(covariance(0, 0));
  const double max_rad = (guided ? config_.max_jump_rad : 0) + 3 * std::sqrt(covariance(3, 3));
  if (jump.translation().norm() > max_m || angle_of(jump) > max_rad) return "refused.jump";
  return {};
}

/// Standing, sixteen beams draw the same sixteen rings again and again, and the filter does not know its tilt to better
/// than the accelerometer's bias: 0.2 degrees put a ring 19 m ahead 6 cm off the road as it is found to be on the way,
/// which is a curb to look at. So the first standstill waits, and is forgotten once the vehicle moves.
bool Mapper::holds_back(const std::vector<LidarPoint>& points, const MapperUpdate& update) {
  if (has_moved_) held_.clear();
  if (has_moved_ || seconds(started_, update.utime) > config_.dense.start_hold_s) return false;
  if (held_.size() < kMostHeld) held_.push_back({points, update.T_map_base, update.utime});
  return true;
}

std::vector<TileKey> Mapper::insert_held() {
  std::set<TileKey> grown;
  for (const Held& held : held_) {
    for (const TileKey& key : dense_.insert(held.points, held.T_map_base, held.utime, true)) grown.insert(key);
  }
  held_.clear();
  return {grown.begin(), grown.end()};
}

std::vector<TileKey> Mapper::finish() {
  std::vector<TileKey> grown = insert_held();  // it never moved: then that is all there is
  for (const TileKey& key : dense_.finish()) grown.push_back(key);
  return grown;
}

void Mapper::insert(const std::vector<LidarPoint>& points, MapperUpdate& update) {
  const Pose since_keyframe = T_map_keyframe_.inverse() * update.T_map_base;
  if (counters_["keyframes"] < kFirstInsertions || since_keyframe.translation().norm() > config_.keyframe_m ||
      angle_of(since_keyframe) > config_.keyframe_rad) {
    counters_.add("keyframes");
    T_map_keyframe_ = update.T_map_base;
    registration_->insert(points, update.T_map_base);
    (void)registration_->keep_around(update.T_map_base.translation());
  }
  const Pose since_moved = T_map_moved_.inverse() * update.T_map_base;
  if (since_moved.translation().norm() > 0.05 || angle_of(since_moved) > 0.01) {
    T_map_moved_ = update.T_map_base;
    moved_ = update.utime;
    has_moved_ = true;
  }
  const double standing = seconds(moved_, update.utime);
  if (!update.with_odometry && standing > 0.5) update.stationary = true;
  if (holds_back(points, update)) return;
  for (const TileKey& key : insert_held()) update.grown.push_back(key);
  const std::vector<TileKey> grown =
      dense_.insert(points, update.T_map_base, update.utime, standing < config_.dense.standing_s);
  update.grown.insert(update.grown.end(), grown.begin(), grown.end());
}

}  // namespace curbstone
