#pragma once

#include <array>

#include "services/ekf/inputs/wheel_odometer.hpp"
#include "services/ekf/model/estimate.hpp"
#include "services/ekf/model/mechanisation.hpp"

namespace curbstone::ekf::filter {

/// The vehicle's motion after a standstill by the IMU alone, compared with the wheels.
///
/// At a standstill speed, tilt and biases are known. For some seconds from then on the IMU alone knows the speed v to a
/// few percent, whatever the wheels show. The wheels are disowned where their speed u differs by more than a wrong
/// radius and the IMU's error explain:
///     |u - v| > kWrong |v| + kSure sqrt(H P H^T + R)
/// with P of the unaided belief, which has not used the wheels. This must hold for their mean, which does not depend on
/// the track width, and for each wheel (the gyro shows an error of one wheel alone). The difference must also have
/// grown as the vehicle sped up: a difference that appeared at once is a leap of the IMU, or of the wheels (SlipJudge).
/// Smaller differences are left to the filter. When the wheels are disowned they have pulled the filter's belief along,
/// so the unaided belief replaces it. Wheels that spin on ice are disowned likewise, and used again as soon as they
/// agree.
///
/// Pure; one thread.
class Launch {
 public:
  static constexpr double kMaxDuration = 6.0;  ///< s; after that the filter knows more than the IMU alone

  /// Starts from the belief at the standstill, at the time of the IMU sample `last`.
  Launch(const base::EkfConfig& config, const model::Geometry& geometry, const model::Belief& belief,
         const model::TimedInertial& last);

  /// As Mechanisation::advance(). Returns false where the comparison has ended, because the IMU had a gap or a jolt, or
  /// kMaxDuration has passed.
  [[nodiscard]] bool advance(std::int64_t utime, const model::TimedInertial* next);
  void set_last_imu(const model::TimedInertial& sample) { mechanisation_.set_last_imu(sample); }

  void set_noise(const base::NoiseConfig& noise) { mechanisation_.set_noise(noise); }

  /// Takes the next interval of the wheels; `sigma`: m/s, 1 sigma of their speeds. Returns whether the wheels are
  /// disowned.
  [[nodiscard]] bool rejects_wheels(const inputs::WheelInterval& interval, const std::array<double, 2>& sigma);
  /// Begins the next interval.
  void begin_interval() { mechanisation_.window().reset(); }
  [[nodiscard]] const model::Belief& belief() const { return belief_; }
  [[nodiscard]] const model::Mechanisation& mechanisation() const { return mechanisation_; }

  /// Widens the published estimate while it is not decided whether the wheels are wrong.
  void inflate_covariance(model::Estimate& estimate, const model::Belief& of_filter) const;

  /// Whether disowned wheels agree again with the filter, which has not used them since.
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
  int disagreed_ = 0;   // intervals in a row
  bool suspicious_ = false;
  bool jolted_ = false;             // the IMU's speed has leapt too far to be used any more
  double largest_leap_ = 0.0;       // m/s, of the wheels against the IMU within two intervals
  std::array<Speeds, 3> recent_{};  // of the last intervals, newest last
};

}  // namespace curbstone::ekf::filter
