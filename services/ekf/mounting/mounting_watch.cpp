#include "services/ekf/mounting/mounting_watch.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "common/geometry/geometry.hpp"

namespace curbstone::ekf::mounting {

namespace {

constexpr double kInterval = 0.2;      // s: counter steps are small against the motion in it
constexpr double kMaxInterval = 0.5;   // s, of an interval: if it is longer, samples are missing
constexpr int kMinSamples = 3;         // IMU samples in an interval
constexpr double kFirstGravity = 2.0;  // s after which the direction of gravity is judged
constexpr double kMinForce = 7.0;      // m/s^2: no road reduces it further for seconds
constexpr double kMaxForce = 14.0;     // m/s^2: nor increases it further, with a scale that is a little wrong

constexpr double kMinTurn = 0.05;    // rad^2/s, turn beyond what the speed explains: 9 deg/s for 2 s
constexpr int kStretches = 2;        // of that much turning
constexpr double kTurnsAlike = 0.7;  // minimum of TurnFit::explained()

constexpr double kSlow = 3.0;            // s: slower changes are tilt and bias
constexpr double kMinMotion = 2.0;       // m^2/s^3: 1 m/s^2 for 2 s
constexpr double kMaxMotion = 20.0;      // m^2/s^3, beyond which the sums are halved
constexpr double kExplained = 0.5;       // minimum share of the force's square
constexpr double kMirrorMargin = 0.2;    // share by which the mirror image must explain it better
constexpr double kMirroredFor = 10.0;    // s in a row: wheels that slip for that long look like anything
constexpr double kMirroredMotion = 1.5;  // m^2/s^3 of motion in that time
constexpr double kBend = 8.0;            // s, duration of a bend
constexpr double kTurning = 0.1;         // rad/s, of the wheels
constexpr double kTurningLong = 2.0;     // s at that rate: a wheel's jolt is one interval, which anything explains
constexpr double kLongTurn = 0.1;        // rad^2/s
constexpr double kLying = 0.8;           // minimum share of the wheels' turn that the rate about a level axis explains
constexpr double kUpright = 0.2;         // maximum share of it in the rate about z
constexpr double kMinGain = 0.5, kMaxGain = 2.0;
constexpr double kTurnStep = 0.1;  // rad, by which a newly measured yaw must differ to be used
constexpr double kSense = 0.004;   // rad^2/s, turn that shows its sense: 3 deg/s for 2 s

}  // namespace

MountingWatch::MountingWatch(const VehicleConfig& vehicle)
    : R_base_imu_(vehicle.T_base_imu().linear()),
      radius_(vehicle.wheel_radius),
      track_(vehicle.track_width),
      setting_off_(vehicle) {}

void MountingWatch::add(const base::ImuSample& sample) {
  const double dt = last_imu_ ? base::seconds_between(last_imu_->utime, sample.utime) : 0.0;
  if (dt < 0.0 && dt > -1.0) return;  // late: not worth a rewind
  last_imu_ = sample;
  setting_off_.add(sample);
  const Eigen::Vector3d force = R_base_imu_ * sample.acceleration;
  ++imu_samples_;
  force_sum_ += force;
  rate_sum_ += R_base_imu_ * sample.angular_rate;
  if (dt <= 0.0 || dt > kMaxInterval) return;
  gravity_seconds_ = std::min(gravity_seconds_ + dt, kGravityMemory);
  gravity_ += dt / gravity_seconds_ * (force - gravity_);
  if (gravity_seconds_ >= kFirstGravity) tilted_ = gravity_points_aside();
  update_turn();
}

void MountingWatch::restart_interval(const base::WheelSample& sample) {
  begin_ = sample;
  imu_samples_ = 0;
  force_sum_.setZero();
  rate_sum_.setZero();
}

void MountingWatch::add(const base::WheelSample& sample) {
  if (const auto start = setting_off_.add(sample)) note_start(*start);
  const double seconds = begin_ ? base::seconds_between(begin_->utime, sample.utime) : -kMaxInterval;
  if (seconds < 0.0 && seconds > -kMaxInterval) return;
  if (seconds >= 0.0 && seconds < kInterval) return;
  if (seconds < 0.0 || seconds > kMaxInterval || imu_samples_ < kMinSamples) {
    before_.reset();
    return restart_interval(sample);
  }
  const double left = radius_ * (sample.angle[0] - begin_->angle[0]) / seconds;
  const double right = radius_ * (sample.angle[1] - begin_->angle[1]) / seconds;
  const Eigen::Vector3d force = force_sum_ / imu_samples_;
  const Eigen::Vector3d rate = rate_sum_ / imu_samples_;
  check({seconds, 0.5 * (left + right), (right - left) / track_, rate.z(), rate.head<2>(), force.head<2>(), force.z()});
  restart_interval(sample);
}

void MountingWatch::check(const Interval& interval) {
  lean_.add(interval.seconds, {interval.force.x(), interval.force.y(), interval.up}, interval.speed,
            std::max(std::abs(interval.gyro_rate), std::abs(interval.wheel_rate)));
  check_turn(interval);
  check_sense(interval);
  check_gyro_up(interval);
  if (before_) check_forward(*before_, interval);
  before_ = interval;
  update_turn();
}

/// Slip looks like anything for a while: kStretches in a row must agree.
void MountingWatch::check_turn(const Interval& interval) {
  turn_scale_.add(interval.seconds, interval.speed, interval.wheel_rate, interval.gyro_rate,
                  interval.force - Eigen::Vector2d(mean_force_.real(), mean_force_.imag()));
  turn_.add(interval.seconds, interval.speed, interval.wheel_rate, interval.gyro_rate);
  if (turn_.turn() < kMinTurn) return;
  const TurnFit turn = std::exchange(turn_, {});
  const double gain = turn.gain();
  if (turn.explained() < kTurnsAlike || std::abs(gain) < kMinGain || std::abs(gain) > kMaxGain) return;
  opposite_stretches_ = gain < 0 ? opposite_stretches_ + 1 : 0;
  opposite_ = opposite_stretches_ >= kStretches || (opposite_ && gain < 0);
}

/// Uses the last kBend seconds, including what is proportional to the speed, as in an even bend: slip does not cause a
/// rate about a level axis, so one bend is enough.
void MountingWatch::check_gyro_up(const Interval& interval) {
  const double kept = std::max(1.0 - interval.seconds / kBend, 0.0);
  upright_.fade(kept);
  upright_.add(interval.seconds, 0.0, interval.wheel_rate, interval.gyro_rate);
  turning_ = kept * turning_ + (std::abs(interval.wheel_rate) > kTurning ? interval.seconds : 0.0);
  const double turn = upright_.wheel_turn();
  const bool enough = turn >= kLongTurn && turning_ >= kTurningLong && upright_.turn() < kUpright * turn;
  for (int i = 0; i < 2; ++i) {
    TurnFit& fit = level_[static_cast<std::size_t>(i)];
    fit.fade(kept);
    fit.add(interval.seconds, 0.0, interval.wheel_rate, interval.level_rate[i]);
    const bool as_far = fit.turn() > turn / (kMaxGain * kMaxGain) && fit.turn() < turn / (kMinGain * kMinGain);
    if (enough && as_far && fit.explained() > kLying)
      gyro_up_ = Eigen::Vector2d::Unit(i) * (fit.gain() < 0 ? -1.0 : 1.0);
  }
}

/// Compares the change of speed between the centres of two intervals with the mean force of both.
void MountingWatch::check_forward(const Interval& before, const Interval& interval) {
  const double seconds = 0.5 * (before.seconds + interval.seconds);
  const Eigen::Vector2d mean = 0.5 * (before.force + interval.force);
  const double sideways = 0.5 * (before.speed * before.gyro_rate + interval.speed * interval.gyro_rate);
  const Complex force(mean.x(), mean.y());
  const Complex motion((interval.speed - before.speed) / seconds, sideways);
  mean_seconds_ = std::min(mean_seconds_ + seconds, kSlow);
  mean_force_ += seconds / mean_seconds_ * (force - mean_force_);
  mean_motion_ += seconds / mean_seconds_ * (motion - mean_motion_);
  const Complex quick_force = force - mean_force_;
  const Complex quick_motion = motion - mean_motion_;
  force_square_ += seconds * std::norm(quick_force);
  motion_square_ += seconds * std::norm(quick_motion);
  product_ += seconds * quick_force * std::conj(quick_motion);
  mirror_product_ += seconds * quick_force * quick_motion;
  if (motion_square_ > kMaxMotion) {
    force_square_ *= 0.5;
    motion_square_ *= 0.5;
    product_ *= 0.5;
    mirror_product_ *= 0.5;
  }
  if (motion_square_ < kMinMotion) return;
  check_handedness(seconds, seconds * std::norm(quick_motion));
  const double gain = std::abs(product_) / motion_square_;
  const bool explained = std::norm(product_) > kExplained * force_square_ * motion_square_;
  if (!explained || gain < kMinGain || gain > kMaxGain) return;
  yaw_is_wrong_ = std::abs(std::arg(product_)) > (yaw_is_wrong_ ? 0.5 : 1.0) * kMaxYaw;
  const bool has_turned = start_yaw_ && std::abs(std::arg(product_ * std::polar(1.0, *start_yaw_))) > kMaxYaw;
  if (has_turned) start_yaw_.reset();
}

void MountingWatch::note_start(const SettingOff::Start& start) {
  const bool wrong = std::abs(start.yaw) > kMaxStartYaw;
  start_yaw_ = wrong ? std::optional(start.yaw) : std::nullopt;
  set_off_ahead_ = start.ahead;
  if (!wrong) yaw_is_wrong_ = false;
}

void MountingWatch::check_sense(const Interval& interval) {
  if (!goes_backwards()) {
    sense_fit_ = {};
    sense_ = 0;
    return;
  }
  sense_fit_.add(interval.seconds, interval.speed, interval.wheel_rate, interval.gyro_rate);
  if (sense_fit_.turn() < kSense) return;
  const TurnFit fit = std::exchange(sense_fit_, {});
  if (fit.explained() > kTurnsAlike && std::abs(fit.gain()) > kMinGain && std::abs(fit.gain()) < kMaxGain)
    sense_ = fit.gain() < 0 ? -1 : 1;
}

/// Slip looks like anything for a while: the result must last, and explain more of the motion.
void MountingWatch::check_handedness(double seconds, double motion) {
  const double all = force_square_ * motion_square_;
  const double direct = std::norm(product_) / all;
  const double mirrored = std::norm(mirror_product_) / all;
  const double gain = std::abs(mirror_product_) / motion_square_;
  const bool is_mirrored =
      mirrored > std::max(kExplained, direct + kMirrorMargin) && gain > kMinGain && gain < kMaxGain;
  if (!is_mirrored) {
    mirrored_seconds_ = mirrored_motion_ = 0.0;
    mirrored_ = mirrored_ && direct < std::max(kExplained, mirrored + kMirrorMargin);
    return;
  }
  mirrored_seconds_ += seconds;
  mirrored_motion_ += motion;
  mirrored_ = mirrored_ || (mirrored_seconds_ > kMirroredFor && mirrored_motion_ > kMirroredMotion);
}

std::vector<MountingWatch::Verdict> MountingWatch::verdicts() const {
  std::vector<Verdict> verdicts;
  if (wrong_up()) verdicts.push_back(Verdict::kWrongUp);
  if (wrong_gravity()) verdicts.push_back(Verdict::kWrongGravity);
  if (leans() && verdicts.empty()) verdicts.push_back(Verdict::kLeans);
  if (wheels_count_backwards()) {
    verdicts.push_back(Verdict::kWheelsCountBackwards);
    return verdicts;
  }
  if (turns_opposite()) verdicts.push_back(Verdict::kTurnsOpposite);
  if (mirrored()) verdicts.push_back(Verdict::kMirrored);
  if (wrong_gyro_up())
    verdicts.push_back(Verdict::kWrongGyroUp);
  else if (gyro_is_wrong())
    verdicts.push_back(Verdict::kGyroIsWrong);
  else if (wrong_turn_scale())
    verdicts.push_back(Verdict::kWrongTurnScale);
  if (is_undecided())
    verdicts.push_back(Verdict::kSetsOffTheOtherWay);
  else if (missing_yaw())
    verdicts.push_back(Verdict::kMissingYaw);
  return verdicts;
}

bool MountingWatch::gravity_points_aside() const {
  return gravity_.z() < std::cos(kMaxTilt) * gravity_.norm();
}

bool MountingWatch::may_have_wrong_up() const {
  return tilted_ || (gravity_seconds_ >= kFirstForce && gravity_points_aside());
}

std::optional<Eigen::Vector3d> MountingWatch::wrong_up() const {
  if (!tilted_) return {};
  return R_base_imu_.transpose() * gravity_.normalized();
}

std::optional<double> MountingWatch::wrong_gravity() const {
  const double force = gravity_.norm();
  if (gravity_seconds_ < kFirstForce || (force > kMinForce && force < kMaxForce)) return {};
  return force;
}

bool MountingWatch::gyro_is_wrong() const {
  const auto scale = wrong_turn_scale();
  if (wrong_gyro_up()) return true;
  return scale && !TurnScale::is_plausible(*scale);
}

std::optional<double> MountingWatch::wrong_turn_scale() const {
  return tilted_ || opposite_ ? std::nullopt : turn_scale_.wrong_scale();
}

std::optional<Eigen::Vector3d> MountingWatch::wrong_gyro_up() const {
  if (gyro_up_.isZero() || tilted_) return {};
  return R_base_imu_.transpose() * Eigen::Vector3d(gyro_up_.x(), gyro_up_.y(), 0.0);
}

std::optional<Eigen::Vector2d> MountingWatch::mirrored() const {
  if (!mirrored_ || tilted_) return {};
  const Complex ahead = mirror_product_ / std::abs(mirror_product_);  // where a force ahead appears
  return Eigen::Vector2d(ahead.real(), ahead.imag());
}

std::optional<double> MountingWatch::missing_yaw() const {
  if (tilted_ || mirrored_) return {};
  if (start_yaw_) return start_yaw_;
  return yaw_is_wrong_ ? std::optional(-std::arg(product_)) : std::nullopt;
}

bool MountingWatch::goes_backwards() const {
  return std::abs(missing_yaw().value_or(0.0)) >= kBackwards;
}

void MountingWatch::update_turn() {
  const double wanted = goes_backwards() && !imu_looks_backwards() ? 0.0 : missing_yaw().value_or(0.0);
  if (std::abs(std::remainder(wanted - imu_turn_, 2.0 * std::numbers::pi)) > kTurnStep) imu_turn_ = wanted;
}

base::ImuSample MountingWatch::turned(base::ImuSample sample) const {
  if (imu_turn_ == 0.0) return sample;
  const Eigen::Matrix3d turn = R_base_imu_.transpose() * rotation_from_rpy(0.0, 0.0, imu_turn_) * R_base_imu_;
  sample.angular_rate = turn * sample.angular_rate;
  sample.acceleration = turn * sample.acceleration;
  sample.turned = imu_turn_;
  return sample;
}

void MountingWatch::begin_with(double imu_turn) {
  imu_turn_ = imu_turn;
  if (imu_turn != 0.0) start_yaw_ = imu_turn;
  set_off_ahead_ = true;  // it was the IMU, if it is about pi
}

}  // namespace curbstone::ekf::mounting
