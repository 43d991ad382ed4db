#include "services/mapper/mapper.hpp"

#include <algorithm>
#include <cmath>

#include "services/mapper/icp_registration.hpp"

namespace curbstone {
namespace {

constexpr double kLongestStride = 1.0;  // s: after that, a constant velocity is no expectation any more
constexpr double kAcceleration = 10.0;  // m/s a revolution's time, what velocity may be off by without odometry
constexpr double kTurning = 2.0;        // rad/s, the same for rotation
constexpr int kDeskewPasses = 2;        // without odometry
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

SweepMotion sweep_from(const OdometryHistory& odometry, const Revolution& revolution) {
  SweepMotion sweep;
  const Pose T_end_odom = odometry.at(revolution.end).inverse();
  const auto step = static_cast<std::int64_t>(std::llround(sweep.step * 1e6));
  for (std::int64_t t = revolution.start; t < revolution.end + step; t += step) {
    sweep.T_end_at.push_back(T_end_odom * odometry.at(std::min(t, revolution.end)));
  }
  if (sweep.T_end_at.size() < 2) sweep.T_end_at.resize(2, Pose::Identity());
  return sweep;
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
      registration_(std::make_unique<IcpRegistration>(config.icp)),
      dense_(config.dense) {}

std::optional<MapperUpdate> Mapper::process(const Revolution& revolution, const OdometryHistory& odometry) {
  counters_.add("revolutions");
  if (revolution.points.size() < static_cast<std::size_t>(config_.min_points)) {
    counters_.add("refused.sparse");
    return std::nullopt;
  }
  if (last_ && std::abs(revolution.start - last_->end) < 1'000'000'000 && revolution.end <= last_->end) {
    counters_.add("refused.time");  // the clock went back a little; a large jump is a new clock
    last_->end = revolution.end;
    return std::nullopt;
  }
  MapperUpdate update;
  update.utime = revolution.end;
  update.revolution = revolution.number;
  if (!last_) {
    start(revolution, odometry, update);
    return update;
  }

  const Expectation expected = expect(revolution, odometry);
  update.with_odometry = expected.with_odometry;
  if (!expected.with_odometry) counters_.add("without_odometry");
  const double stride = seconds(last_->end, revolution.end);
  drift_ +=
      expected.with_odometry
          ? isotropic(config_.prior_floor_m + config_.prior_translation * expected.T_last_base.translation().norm(),
                      config_.prior_floor_rad + config_.prior_rotation * angle_of(expected.T_last_base))
          : isotropic(kAcceleration * std::clamp(stride, 0.05, 1.0), kTurning * std::clamp(stride, 0.05, 1.0));

  const PosePrior prior = prior_of(expected);
  std::vector<LidarPoint> points;
  update.registration = align(revolution, expected, points);
  update.registered = believe(update.registration, prior, expected.with_odometry);
  if (first_ && !finish_start(update)) {
    start(revolution, odometry, update);
    return update;
  }
  update.T_map_base = update.registered ? update.registration.T_map_base : prior.T_map_base;
  const Pose moved = last_->T_map_base.inverse() * update.T_map_base;
  update.stationary = expected.stationary && moved.translation().norm() < 0.03 && angle_of(moved) < 0.01;
  if (update.stationary) update.T_map_base = last_->T_map_base;
  if (odometry.covers(revolution.end, revolution.end)) {
    T_map_odom_ = normalised(update.T_map_base * odometry.at(revolution.end).inverse());
  }
  update.T_map_odom = T_map_odom_;
  twist_ = stride > 0 && stride < kLongestStride ? twist_of(moved, stride) : Twist{};
  last_ = Last{revolution.end, update.T_map_base};
  if (update.registered) {
    refused_in_a_row_ = 0;
    drift_.setZero();
    insert(points, update);
  } else {
    ++refused_in_a_row_;
  }
  return update;
}

void Mapper::start(const Revolution& revolution, const OdometryHistory& odometry, MapperUpdate& update) {
  update.with_odometry = odometry.covers(revolution.start, revolution.end);
  const SweepMotion sweep = update.with_odometry ? sweep_from(odometry, revolution)
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
  moved_ = revolution.end;
  T_map_moved_ = T_map_keyframe_ = update.T_map_base;
  if (first_) {
    begin_registration_map({});
  } else {
    insert(in_base(revolution, sweep), update);
  }
}

Mapper::Expectation Mapper::expect(const Revolution& revolution, const OdometryHistory& odometry) const {
  Expectation expected;
  const std::int64_t from = std::min(last_->end, revolution.start);
  expected.with_odometry = odometry.covers(from, revolution.end);
  if (expected.with_odometry) {
    expected.T_last_base = odometry.at(last_->end).inverse() * odometry.at(revolution.end);
    expected.stationary = odometry.stationary(from, revolution.end);
  } else {
    const double stride = seconds(last_->end, revolution.end);
    if (stride > 0) expected.T_last_base = move(twist_, std::min(stride, kLongestStride));
  }
  expected.sweep = odometry.covers(revolution.start, revolution.end)
                       ? sweep_from(odometry, revolution)
                       : steady_sweep(twist_, seconds(revolution.start, revolution.end));
  return expected;
}

PosePrior Mapper::prior_of(const Expectation& expected) const {
  return {normalised(last_->T_map_base * expected.T_last_base), drift_.inverse()};
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
/// the expectation did, so de-skew and register again until both agree. What de-skew assumes comes out again about
/// half, so the correction is doubled.
RegistrationResult Mapper::align(const Revolution& revolution, const Expectation& expected,
                                 std::vector<LidarPoint>& points) {
  PosePrior prior = prior_of(expected);
  points = in_base(revolution, expected.sweep);
  RegistrationResult result = registration_->align(points, prior);
  const double stride = seconds(last_->end, revolution.end);
  if (expected.with_odometry || !(stride > 0 && stride < kLongestStride)) return result;
  const double sweep_seconds = seconds(revolution.start, revolution.end);
  Twist assumed = twist_;
  for (int pass = 0; pass < kDeskewPasses && result.converged; ++pass) {
    const Twist found = twist_of(last_->T_map_base.inverse() * result.T_map_base, stride);
    if ((found.linear - assumed.linear).norm() * sweep_seconds < 0.01 &&
        (found.angular - assumed.angular).norm() * sweep_seconds < 1e-3) {
      break;
    }
    assumed = found;
    points = in_base(revolution, steady_sweep(assumed, sweep_seconds));
    prior.T_map_base = last_->T_map_base * move(assumed, stride);
    if (first_) begin_registration_map(assumed);
    result = registration_->align(points, prior);
  }
  return result;
}

/// The second revolution tells whether the first was any good: if it fits, the first goes into the map, else it is
/// forgotten and the second becomes the first.
bool Mapper::finish_start(MapperUpdate& update) {
  if (update.registered) {
    update.grown = dense_.insert(first_points_, last_->T_map_base, last_->end);
  } else {
    registration_ = std::make_unique<IcpRegistration>(config_.icp);
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
  registration_ = std::make_unique<IcpRegistration>(config_.icp);
  registration_->insert(first_points_, last_->T_map_base);
}

bool Mapper::believe(const RegistrationResult& result, const PosePrior& prior, bool with_odometry) {
  const Pose jump = prior.T_map_base.inverse() * result.T_map_base;
  const double sigma_m = std::sqrt(drift_(0, 0));
  const double sigma_rad = std::sqrt(drift_(3, 3));
  const double max_m = (with_odometry ? config_.max_jump_m : 0) + 3 * sigma_m;
  const double max_rad = (with_odometry ? config_.max_jump_rad : 0) + 3 * sigma_rad;
  const char* reason = nullptr;
  if (!result.converged)
    reason = "refused.not_converged";
  else if (result.inlier_ratio < config_.min_inliers)
    reason = "refused.inliers";
  else if (result.residual > config_.max_residual)
    reason = "refused.residual";
  else if (jump.translation().norm() > max_m || angle_of(jump) > max_rad)
    reason = "refused.jump";
  if (reason != nullptr) counters_.add(reason);
  return reason == nullptr;
}

void Mapper::insert(const std::vector<LidarPoint>& points, MapperUpdate& update) {
  const Pose since_keyframe = T_map_keyframe_.inverse() * update.T_map_base;
  if (counters_["keyframes"] < kFirstInsertions || since_keyframe.translation().norm() > config_.keyframe_m ||
      angle_of(since_keyframe) > config_.keyframe_rad) {
    counters_.add("keyframes");
    T_map_keyframe_ = update.T_map_base;
    registration_->insert(points, update.T_map_base);
    registration_->keep_around(update.T_map_base.translation());
  }
  const Pose since_moved = T_map_moved_.inverse() * update.T_map_base;
  if (since_moved.translation().norm() > 0.05 || angle_of(since_moved) > 0.01) {
    T_map_moved_ = update.T_map_base;
    moved_ = update.utime;
  }
  const double standing = seconds(moved_, update.utime);
  if (!update.with_odometry && standing > 0.5) update.stationary = true;
  const std::vector<TileKey> grown =
      dense_.insert(points, update.T_map_base, update.utime, standing < config_.dense.standing_s);
  update.grown.insert(update.grown.end(), grown.begin(), grown.end());
}

}  // namespace curbstone
