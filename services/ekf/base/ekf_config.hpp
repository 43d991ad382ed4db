#pragma once

#include "common/config/config.hpp"
#include "common/config/vehicle.hpp"

namespace curbstone::ekf::base {

/// Process noise of the prediction. Densities: a white rate error of density d integrates to d sqrt(t) after t seconds.
/// Defaults: an MTi-class MEMS unit on a running vehicle (vibration included), not on a bench.
struct NoiseConfig {
  double gyro = 1.3e-4;                   ///< rad/s/sqrt(Hz)
  double accelerometer = 1e-2;            ///< m/s^2/sqrt(Hz)
  double gyro_bias_walk = 2e-5;           ///< rad/s/sqrt(s)
  double accelerometer_bias_walk = 2e-4;  ///< m/s^2/sqrt(s)
  double wheel_scale_walk = 1e-5;         ///< 1/sqrt(s)
  double coasting_rate = 0.02;            ///< rad/s/sqrt(Hz): yaw rate noise while there is no IMU
  double coasting_acceleration = 1.5;     ///< m/s^2/sqrt(Hz): acceleration noise while there is no IMU

  void visit(ConfigVisitor& v) {
    v.field("gyro", gyro, {1e-6, 1.0}, "rad/s/sqrt(Hz), noise density, vibration included");
    v.field("accelerometer", accelerometer, {1e-6, 10.0}, "m/s^2/sqrt(Hz), noise density, vibration included");
    v.field("gyro_bias_walk", gyro_bias_walk, {0.0, 0.1}, "rad/s/sqrt(s), random walk of the bias");
    v.field("accelerometer_bias_walk", accelerometer_bias_walk, {0.0, 1.0}, "m/s^2/sqrt(s), random walk of the bias");
    v.field("wheel_scale_walk", wheel_scale_walk, {0.0, 0.1}, "1/sqrt(s), random walk of radii and track");
    v.field("coasting_rate", coasting_rate, {1e-4, 10.0}, "rad/s/sqrt(Hz), turning while there is no IMU");
    v.field("coasting_acceleration", coasting_acceleration, {1e-3, 100.0},
            "m/s^2/sqrt(Hz), change of speed while there is no IMU");
  }
};

/// Measurement noise of the wheels, and how strictly the non-holonomic constraint holds.
struct WheelsConfig {
  double interval = 0.05;  ///< s, minimum interval over which counts are differenced: against jitter and quantisation
  double speed_noise = 0.007;     ///< m/s, 1 sigma of a wheel's mean speed over an interval
  double slip_noise = 0.003;      ///< 1 sigma, share of the speed: the little slip of every tyre
  double stamp_noise = 2e-4;      ///< s, 1 sigma of a stamp
  double angle_noise = 3e-4;      ///< rad, 1 sigma of an angle: quantisation
  double lateral_noise = 0.03;    ///< m/s, 1 sigma of sideways speed at the axle
  double vertical_noise = 0.06;   ///< m/s, 1 sigma of vertical speed at the axle, in base_link
  double axle = 0.0;              ///< m, forward of base_link: the point that does not move sideways in a turn
  double axle_sigma = 0.3;        ///< m, 1 sigma of `axle` at the start; 0: exact
  double course_sigma = 0.004;    ///< rad, 1 sigma at the start of the rolling direction in base_link; 0: exact
  double scale_sigma = 0.01;      ///< 1 sigma at the start of the scale error that both radii share
  double mismatch_sigma = 0.003;  ///< 1 sigma at the start of each radius on its own
  double track_sigma = 0.02;      ///< 1 sigma of the track width, relative
  double max_speed = 40.0;        ///< m/s, of a wheel: counts that show more are refused

  void visit(ConfigVisitor& v) {
    v.field("interval", interval, {0.005, 0.2}, "s, at least, over which wheel angles are differenced");
    v.field("speed_noise", speed_noise, {1e-4, 1.0}, "m/s, 1 sigma of a wheel's mean speed over an interval");
    v.field("slip_noise", slip_noise, {0.0, 1.0}, "1 sigma, share of the speed");
    v.field("stamp_noise", stamp_noise, {0.0, 0.05}, "s, 1 sigma of a stamp");
    v.field("angle_noise", angle_noise, {0.0, 0.5}, "rad, 1 sigma of a wheel angle (quantisation)");
    v.field("lateral_noise", lateral_noise, {1e-3, 10.0}, "m/s, 1 sigma of sideways speed at the axle");
    v.field("vertical_noise", vertical_noise, {1e-3, 10.0}, "m/s, 1 sigma of vertical speed at the axle");
    v.field("axle", axle, {-10.0, 10.0}, "m, forward of base_link: the point that does not move sideways in a turn");
    v.field("axle_sigma", axle_sigma, {0.0, 5.0}, "m, 1 sigma of it at the start; 0: exact");
    v.field("course_sigma", course_sigma, {0.0, 0.5},
            "rad, 1 sigma of the way it rolls against base_link's x, to the side and up; 0: exact");
    v.field("scale_sigma", scale_sigma, {0.0, 0.5}, "1 sigma of an error that both radii share; 0: exact");
    v.field("mismatch_sigma", mismatch_sigma, {0.0, 0.5}, "1 sigma of each radius on its own; 0: exact");
    v.field("track_sigma", track_sigma, {0.0, 0.5}, "1 sigma of the track width, relative; 0: exact");
    v.field("max_speed", max_speed, {0.1, 200.0}, "m/s, a faster wheel is refused");
  }
};

/// When the vehicle counts as standing, and how certain that is. Wheels alone do not prove it (the vehicle may slide,
/// be pushed or be lifted), nor does the IMU (the vehicle may roll evenly): both must agree.
struct StandstillConfig {
  double window = 0.5;             ///< s of quiet data required
  double travel = 5e-4;            ///< m, maximum travel of each wheel in the window
  double gyro_std = 0.01;          ///< rad/s, maximum standard deviation in the window, each axis
  double acceleration_std = 0.15;  ///< m/s^2, maximum standard deviation in the window, each axis
  double max_rate = 0.05;          ///< rad/s, maximum mean of gyro minus bias: an even turn is no standstill
  double speed_noise = 0.005;      ///< m/s, 1 sigma of a zero-velocity update
  double rate_noise = 3e-5;        ///< rad/s/sqrt(Hz), noise of the zero-rate update in addition to the gyro's own

  void visit(ConfigVisitor& v) {
    v.field("window", window, {0.1, 10.0}, "s that must be quiet");
    v.field("travel", travel, {1e-6, 0.1}, "m, at most, that each wheel moved in the window");
    v.field("gyro_std", gyro_std, {1e-4, 1.0}, "rad/s, at most, standard deviation in the window, each axis");
    v.field("acceleration_std", acceleration_std, {1e-3, 10.0}, "m/s^2, at most, standard deviation, each axis");
    v.field("max_rate", max_rate, {1e-3, 1.0}, "rad/s, at most, mean of the gyro less its bias");
    v.field("speed_noise", speed_noise, {1e-4, 1.0}, "m/s, 1 sigma of a zero-velocity update");
    v.field("rate_noise", rate_noise, {0.0, 0.1}, "rad/s/sqrt(Hz), of a zero-rate update, besides the gyro's noise");
  }
};

/// When wheel measurements are refused.
struct SlipConfig {
  double refuse = 8.0;        ///< sigma: a wheel beyond this is left out; nearer, its weight is reduced
  double yaw_rate = 0.12;     ///< rad/s, difference between wheels and gyro that counts as slip
  double yaw_share = 0.1;     ///< share of the yaw rate that is added to it
  double speed_change = 0.3;  ///< m/s, difference between wheels and accelerometer over `window` that counts as slip
  double window = 0.3;        ///< s
  double hold = 0.3;          ///< s that slip lasts after its last sign
  double patience = 5.0;      ///< s of refused wheels or constraint after which the filter doubts itself instead

  void visit(ConfigVisitor& v) {
    v.field("refuse", refuse, {3.3, 100.0}, "sigma beyond which a wheel is left out");
    v.field("yaw_rate", yaw_rate, {0.001, 10.0}, "rad/s between wheels and gyro that is slip");
    v.field("yaw_share", yaw_share, {0.0, 10.0}, "and this share of the yaw rate on top");
    v.field("speed_change", speed_change, {0.01, 10.0}, "m/s between wheels and accelerometer over the window");
    v.field("window", window, {0.05, 5.0}, "s over which changes of speed are compared");
    v.field("hold", hold, {0.0, 10.0}, "s that slip lasts after its last sign");
    v.field("patience", patience, {0.5, 60.0},
            "s of refused wheels or constraint, after which the filter doubts itself");
  }
};

struct StartConfig {
  double still = 1.0;              ///< s of standstill for a good start
  double patience = 5.0;           ///< s without standstill or motion of the wheels after which it starts anyway
  double moving = 0.3;             ///< s of data for a start on the move
  double gyro_bias_sigma = 0.005;  ///< rad/s, 1 sigma of the prior
  double accelerometer_bias_sigma = 0.03;  ///< m/s^2, 1 sigma of the prior
  double max_gyro_bias = 0.1;              ///< rad/s: a larger mean rate at standstill means a turn or a broken gyro
  double moving_tilt_sigma = 0.05;         ///< rad, 1 sigma of roll and pitch after a start on the move
  double moving_speed_sigma = 0.5;         ///< m/s, 1 sigma of the speed after a start on the move
  double level_sigma = 0.005;              ///< rad, 1 sigma of roll and pitch below which the odometry may be used
  double level_patience = 10.0;            ///< s after which the odometry may be used whatever that sigma

  void visit(ConfigVisitor& v) {
    v.field("still", still, {0.2, 60.0}, "s of standstill for a good start");
    v.field("patience", patience, {0.5, 600.0}, "s without standstill or turning wheels, then it starts anyway");
    v.field("moving", moving, {0.05, 5.0}, "s of data for a start on the move");
    v.field("gyro_bias_sigma", gyro_bias_sigma, {1e-5, 1.0}, "rad/s, 1 sigma before anything is known");
    v.field("accelerometer_bias_sigma", accelerometer_bias_sigma, {1e-4, 5.0}, "m/s^2, 1 sigma likewise");
    v.field("max_gyro_bias", max_gyro_bias, {1e-3, 1.0}, "rad/s: more at standstill is a turn or a broken gyro");
    v.field("moving_tilt_sigma", moving_tilt_sigma, {1e-3, 1.0}, "rad, of roll and pitch after a start on the move");
    v.field("moving_speed_sigma", moving_speed_sigma, {1e-3, 50.0}, "m/s, of the speed after a start on the move");
    v.field("level_sigma", level_sigma, {1e-4, 1.0}, "rad, of roll and pitch from which on the odometry may be used");
    v.field("level_patience", level_patience, {0.0, 600.0}, "s, after which it may be used whatever they are");
  }
};

struct TimingConfig {
  double hold = 0.2;           ///< s of message time to wait for the other sensor: a longer delay counts as a loss
  double max_imu_gap = 0.1;    ///< s, longest gap bridged by IMU samples; beyond it the filter coasts on the wheels
  double max_wheel_gap = 0.2;  ///< s, longest gap between wheel samples whose mean speed is still used
  double history = 2.0;        ///< s of samples that are kept for one that comes later than the hold
  double max_jump = 1.0;       ///< s: a longer step of the stamps is a jump of the clock or a long silence

  void visit(ConfigVisitor& v) {
    v.field("hold", hold, {0.01, 1.0}, "s of message time to wait for the other sensor");
    v.field("max_imu_gap", max_imu_gap, {0.005, 1.0}, "s between IMU samples that is bridged by them");
    v.field("max_wheel_gap", max_wheel_gap, {0.02, 1.0}, "s between wheel samples that still give a speed");
    v.field("history", history, {0.0, 5.0}, "s of samples kept for one that comes late; 0: it is dropped");
    v.field("max_jump", max_jump, {0.1, 60.0}, "s: a longer step of the stamps is a jump of the clock");
  }
};

/// How fast the published odom pose follows a correction of position and heading, because it must not jump.
struct SpreadConfig {
  double share = 0.02;    ///< m per metre driven: less than a mapper allows for (3 % and 1 cm per revolution)
  double turning = 0.01;  ///< rad/s while moving: a rate that a gyro with an unknown bias may show as well

  void visit(ConfigVisitor& v) {
    v.field("share", share, {0.0, 1.0}, "m per metre driven by which odom approaches a corrected position");
    v.field("turning", turning, {0.0, 1.0}, "rad/s, while moving, by which it approaches a corrected heading");
  }
};

/// How the mapper's poses correct the filter (`fuse_map`).
struct MapFusionConfig {
  double baseline = 0.5;  ///< s, minimum time between two poses that are compared
  double delay = 0.3;  ///< s of message time from a pose's stamp to its effect; a pose that arrives after that is late
  double translation_noise = 0.005;  ///< m, 1 sigma of a pose in addition to the covariance in MAP_POSE
  double rotation_noise = 5e-4;      ///< rad, likewise

  void visit(ConfigVisitor& v) {
    v.field("baseline", baseline, {0.05, 1.0}, "s at least between two map poses that are compared");
    v.field("delay", delay, {0.02, 1.0}, "s of message time after its stamp at which a map pose takes effect");
    v.field("translation_noise", translation_noise, {1e-4, 1.0}, "m, 1 sigma of a map pose, beside its own");
    v.field("rotation_noise", rotation_noise, {1e-5, 1.0}, "rad, 1 sigma of a map pose, beside its own");
  }
};

/// Section `ekf:` of the vehicle's file.
struct EkfConfig {
  VehicleConfig vehicle;
  TimingConfig timing;
  StartConfig start;
  NoiseConfig noise;
  WheelsConfig wheels;
  StandstillConfig standstill;
  SlipConfig slip;
  SpreadConfig spread;
  std::string state_file;  ///< the belief, saved ten times a second for a successor process; empty: none
  bool fuse_map = false;
  MapFusionConfig map;

  void visit(ConfigVisitor& v) {
    v.section("vehicle", vehicle, "shared: the vehicle");
    v.section("timing", timing, "order of messages, gaps and jumps");
    v.section("start", start, "how the filter starts");
    v.section("noise", noise, "what disturbs the prediction");
    v.section("wheels", wheels, "what wheels measure");
    v.section("standstill", standstill, "when the vehicle stands");
    v.section("slip", slip, "when wheels are refused");
    v.section("spread", spread, "how odom follows corrections of position and heading without jumps");
    v.field("state_file", state_file,
            "file on a tmpfs for the filter's state, from which the next process continues if this one is killed; "
            "empty: none");
    v.field("fuse_map", fuse_map, "take MAP_POSE back as a correction of speed, biases and wheels");
    v.section("map", map, "how the mapper's poses are used");
  }
};

}  // namespace curbstone::ekf::base
