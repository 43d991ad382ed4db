#pragma once

#include <array>

#include "services/ekf/inputs/wheel_odometer.hpp"
#include "services/ekf/model/estimate.hpp"
#include "services/ekf/model/mechanisation.hpp"

namespace curbstone::ekf::filter {

/// How the vehicle has driven off from a standstill by the IMU alone, and whether the wheels say the same.
///
/// At a standstill speed, tilt and biases are known. For some seconds from then on the IMU alone knows the speed v to a
/// few percent, whatever the wheels say. They are disowned where what they show, u, is farther off than a wrong radius
/// makes it, and than the IMU may err by:
///     |u - v| > kWrong |v| + kSure sqrt(H P H^T + R)
/// with P of the unaided belief, which has not seen the wheels. That must hold of their mean, which no track width
/// changes, and of each: of one wheel alone the gyro tells. And the difference must have grown as it sped up: one that
/// came at once is a leap of the IMU, or of the wheels (SlipJudge). What is off by less is left to the filter. A belief
/// that the wheels have pulled along meanwhile is worthless then, and the unaided one takes its place. Wheels that spin
/// on ice are disowned likewise, and owned again as soon as they agree.
///
/// Pure; one thread.
class Launch {
 public:
  static constexpr double kLongest = 6.0;  ///< s, then the filter knows more than the IMU alone

  /// It leaves a standstill with what is believed then, at the time of the IMU's sample `last`.
  Launch(const base::EkfConfig& config, const model::Geometry& geometry, const model::Belief& belief,
         const model::TimedInertial& last);

  /// As Mechanisation::advance(). False: nothing is known of it any more, because the IMU had a gap or a jolt, or it is
  /// long ago.
  [[nodiscard]] bool advance(std::int64_t utime, const model::TimedInertial* next);
  void set_last_imu(const model::TimedInertial& sample) { mechanisation_.set_last_imu(sample); }

  void set_noise(const base::NoiseConfig& noise) { mechanisation_.set_noise(noise); }

  /// The next interval of the wheels; `sigma`: m/s, of their speeds. Says whether they are disowned.
  [[nodiscard]] bool disowns(const inputs::WheelInterval& interval, const std::array<double, 2>& sigma);
  /// The next interval begins.
  void begin_interval() { mechanisation_.window().reset(); }
  [[nodiscard]] const model::Belief& belief() const { return belief_; }
  [[nodiscard]] const model::Mechanisation& mechanisation() const { return mechanisation_; }

  /// While it is not settled whether the wheels are wrong: what is published covers that.
  void doubt(model::Estimate& estimate, const model::Belief& of_filter) const;

  /// Whether wheels that were disowned agree again with the filter, which has not seen them since.
  [[nodiscard]] static bool agrees(const model::Belief& belief, const model::BodyMotion& motion,
                                   const inputs::WheelInterval& interval, const std::array<double, 2>& sigma,
                                   const model::Geometry& geometry);

 private:
  struct Speeds {
    double wheels = 0.0, imu = 0.0;  // m/s
  };
  void note_leap(const Speeds& now);

  model::Geometry geometry_;
  model::Belief belief_;
  model::Mechanisation mechanisation_;
  std::int64_t begin_;  // us
  int disagreed_ = 0;   // intervals without a break
  bool suspicious_ = false;
  bool jolted_ = false;             // the IMU's speed has leapt so far that it says nothing any more
  double largest_leap_ = 0.0;       // m/s, of the wheels against the IMU within two intervals
  std::array<Speeds, 3> recent_{};  // of the last intervals, newest last
};

}  // namespace curbstone::ekf::filter
