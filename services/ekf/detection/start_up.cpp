#include "services/ekf/detection/start_up.hpp"

#include <cmath>

namespace curbstone::ekf::detection {

namespace {

constexpr double kLevellingFloor = 0.01;  // m/s^2: what the mean over a second at standstill does not average out

base::StandstillConfig with_window(base::StandstillConfig config, double window) {
  config.window = window;
  return config;
}

struct WheelFit {
  double speed = 0.0;         // m/s, at the end
  double acceleration = 0.0;  // m/s^2
};

/// Fits speed and acceleration to the mean speeds of the window's two halves.
WheelFit fit(const std::deque<base::WheelSample>& wheels, double radius) {
  if (wheels.size() < 3) return {};
  const base::WheelSample& a = wheels.front();
  const base::WheelSample& b = wheels[wheels.size() / 2];
  const base::WheelSample& c = wheels.back();
  const auto speed = [&](const base::WheelSample& from, const base::WheelSample& to) {
    return 0.5 * radius * (to.angle[0] - from.angle[0] + to.angle[1] - from.angle[1]) /
           base::seconds_between(from.utime, to.utime);
  };
  const double acceleration = (speed(b, c) - speed(a, b)) / (0.5 * base::seconds_between(a.utime, c.utime));
  return {speed(b, c) + acceleration * 0.5 * base::seconds_between(b.utime, c.utime), acceleration};
}

}  // namespace

void reset_wheel_scale(model::Belief& belief, const base::WheelsConfig& config) {
  belief.mean.wheel_scale.setZero();
  model::ErrorMatrix& P = belief.covariance;
  P.middleRows<3>(model::kWheelScale).setZero();
  P.middleCols<3>(model::kWheelScale).setZero();
  P.block<2, 2>(model::kWheelScale, model::kWheelScale).setConstant(config.scale_sigma * config.scale_sigma);
  P.diagonal().segment<2>(model::kWheelScale).array() += config.mismatch_sigma * config.mismatch_sigma;
  P(model::kWheelScale + 2, model::kWheelScale + 2) = config.track_sigma * config.track_sigma;
}

void reset_accelerometer_bias(model::Belief& belief, const base::StartConfig& config) {
  belief.mean.accelerometer_bias.setZero();
  belief.covariance.middleRows<3>(model::kAccelerometerBias).setZero();
  belief.covariance.middleCols<3>(model::kAccelerometerBias).setZero();
  const double sigma = config.accelerometer_bias_sigma;
  belief.covariance.diagonal().segment<3>(model::kAccelerometerBias).setConstant(sigma * sigma);
}

void reset_axle(model::Belief& belief, const base::WheelsConfig& config) {
  belief.mean.axle = config.axle;
  belief.mean.course.setZero();
  belief.covariance.middleRows<3>(model::kAxle).setZero();
  belief.covariance.middleCols<3>(model::kAxle).setZero();
  belief.covariance(model::kAxle, model::kAxle) = config.axle_sigma * config.axle_sigma;
  belief.covariance.diagonal().segment<2>(model::kCourse).setConstant(config.course_sigma * config.course_sigma);
}

StartUp::StartUp(const base::EkfConfig& config)
    : config_(config),
      geometry_(config.vehicle),
      standing_window_(with_window(config.standstill, config.start.still), config.vehicle.wheel_radius,
                       config.timing.max_wheel_gap),
      moving_window_(with_window(config.standstill, config.start.moving), config.vehicle.wheel_radius,
                     config.timing.max_wheel_gap) {}

std::optional<model::Belief> StartUp::add(const base::WheelSample& sample) {
  standing_window_.add(sample);
  moving_window_.add(sample);
  if (!without_imu_ || sample.utime < *without_imu_) without_imu_ = sample.utime;
  if (seconds_without_imu(sample.utime) < config_.start.patience || !moving_window_.wheels_turn()) return std::nullopt;
  kind_ = Kind::kWithoutImu;
  return moving(sample.utime, on_level_ground());
}

void StartUp::set_noise(const base::NoiseConfig& noise, double gyro, double accelerometer) {
  config_.noise = noise;
  standing_window_.set_noise(gyro, accelerometer);
  moving_window_.set_noise(gyro, accelerometer);
}

void StartUp::reset() {
  standing_window_.reset();
  moving_window_.reset();
  since_.reset();
  without_imu_.reset();
}

std::optional<model::Belief> StartUp::add(const base::ImuSample& sample) {
  if (!since_) since_ = sample.utime;
  without_imu_.reset();
  standing_window_.add(sample);
  moving_window_.add(sample);
  const bool plausible = standing_window_.mean_rate().cwiseAbs().maxCoeff() <= config_.start.max_gyro_bias;
  if (plausible && standing_window_.still(standing_window_.mean_rate())) {
    kind_ = Kind::kStanding;
    return standing(sample.utime);
  }
  if (moving_window_.span() >= config_.start.moving && moving_window_.wheels_turn()) {
    kind_ = Kind::kMoving;
    return moving(sample.utime, measured());
  }
  if (base::seconds_between(*since_, sample.utime) >= config_.start.patience) {
    kind_ = Kind::kImpatient;
    return moving(sample.utime, measured());
  }
  return std::nullopt;
}

model::Belief StartUp::prior(std::int64_t utime, const Eigen::Vector3d& up) const {
  model::Belief belief;
  belief.utime = utime;
  const double roll = std::atan2(up.y(), up.z());
  const double pitch = std::atan2(-up.x(), std::hypot(up.y(), up.z()));
  belief.mean.attitude = Eigen::Quaterniond(rotation_from_rpy(roll, pitch, 0.0));

  const auto square = [](double x) { return x * x; };
  model::ErrorMatrix& P = belief.covariance;
  const Eigen::Vector3d yaw_axis = belief.mean.attitude.conjugate() * Eigen::Vector3d::UnitZ();
  P.block<3, 3>(model::kAttitude, model::kAttitude) = Eigen::Matrix3d::Identity() - yaw_axis * yaw_axis.transpose();
  P.diagonal().segment<3>(model::kGyroBias).setConstant(square(config_.start.gyro_bias_sigma));
  reset_accelerometer_bias(belief, config_.start);
  reset_wheel_scale(belief, config_.wheels);
  reset_axle(belief, config_.wheels);
  return belief;
}

/// Places the IMU by base_link's origin and the attitude: its position error depends on the attitude error alone.
void StartUp::fix_origin(model::Belief& belief) const {
  const Eigen::Matrix3d R = belief.mean.attitude.toRotationMatrix();
  belief.mean.position = -(R * geometry_.to_base);
  model::ErrorMatrix F = model::ErrorMatrix::Identity();
  F.block<3, 3>(model::kPosition, model::kPosition).setZero();
  F.block<3, 3>(model::kPosition, model::kAttitude) = R * skew(geometry_.to_base);
  belief.covariance = (F * belief.covariance * F.transpose()).eval();
}

model::Belief StartUp::standing(std::int64_t utime) const {
  const Eigen::Vector3d acceleration = geometry_.R_base_imu * standing_window_.mean_acceleration();
  const Eigen::Vector3d rate = geometry_.R_base_imu * standing_window_.mean_rate();
  const double averaging = std::sqrt(standing_window_.span());
  model::Belief belief = prior(utime, acceleration);
  const double level_sigma = std::hypot(config_.noise.accelerometer / averaging, kLevellingFloor);
  const double rate_sigma = std::hypot(config_.noise.gyro, config_.standstill.rate_noise) / averaging;
  const auto z = model::stack(model::observe_gravity(belief.mean, acceleration, Eigen::Vector3d::Zero(), level_sigma),
                              model::observe_standing_rate(belief.mean, rate, rate_sigma));
  model::correct(belief, z, model::optimal_gain(belief, z));
  belief.covariance.diagonal()
      .segment<3>(model::kVelocity)
      .setConstant(config_.standstill.speed_noise * config_.standstill.speed_noise);
  fix_origin(belief);
  return belief;
}

model::Inertial StartUp::measured() const {
  return {geometry_.R_base_imu * moving_window_.mean_rate(), geometry_.R_base_imu * moving_window_.mean_acceleration()};
}

model::Inertial StartUp::on_level_ground() const {
  const WheelFit wheels = fit(moving_window_.wheels(), geometry_.wheel_radius);
  return {Eigen::Vector3d::Zero(), Eigen::Vector3d(wheels.acceleration, 0.0, kGravity)};
}

model::Belief StartUp::moving(std::int64_t utime, const model::Inertial& mean) const {
  const Eigen::Vector3d& rate = mean.angular_rate;
  const Eigen::Vector3d& specific_force = mean.acceleration;
  const WheelFit wheels = fit(moving_window_.wheels(), geometry_.wheel_radius);
  const Eigen::Vector3d acceleration(wheels.acceleration, wheels.speed * rate.z(), 0.0);
  model::Belief belief = prior(utime, specific_force - acceleration);
  const auto z =
      model::observe_gravity(belief.mean, specific_force, acceleration, config_.start.moving_tilt_sigma * kGravity);
  model::correct(belief, z, model::optimal_gain(belief, z));
  belief.mean.velocity = Eigen::Vector3d(wheels.speed, 0, 0) - rate.cross(geometry_.to_base);
  belief.covariance.diagonal()
      .segment<3>(model::kVelocity)
      .setConstant(config_.start.moving_speed_sigma * config_.start.moving_speed_sigma);
  fix_origin(belief);
  return belief;
}

}  // namespace curbstone::ekf::detection
