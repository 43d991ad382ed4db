#pragma once

#include <cstdint>
#include <optional>

#include "services/ekf/base/samples.hpp"
#include "services/ekf/model/measurement_model.hpp"

namespace curbstone::ekf::filter {

/// Replaces the vertical part of the specific force while it cannot be true: a bias that has leapt, an accelerometer
/// that overflows or ends at its range.
///
/// A vehicle on the ground does not leave it. What the accelerometer shows upwards beyond gravity and the turn of the
/// velocity may rise and fall with each bump, but its integral stays within kMaxSpeed, whatever the road. Beyond it
/// the vertical part is set to what gravity and the turn alone would show: it adds nothing then, and gyro, wheels and
/// the other two axes go on. kAllowed of the integral is forgotten each second: errors of the tilt, of the scale. What
/// the vertical part has shown in excess from the beginning, for kKnown and more, is its bias and not counted.
///
/// It is used again kTrust after it has come back. While it is used, samples pass bit for bit. A value type; one
/// thread; samples in the order of their stamps.
class VerticalForce {
 public:
  static constexpr double kMaxSpeed = 0.5;  ///< m/s, up or down
  static constexpr double kAllowed = 0.2;   ///< m/s^2
  static constexpr double kRate = 0.01;     ///< rad/s, error of the pitch rate: of a gyro's bias that is not known yet
  static constexpr double kTrust = 2.0;     ///< s
  static constexpr double kQuiet = 0.1;     ///< m/s^2/sqrt(Hz): up to this noise the limits are those above
  static constexpr double kKnown = 3.0;     ///< s of samples, before which nothing is judged
  static constexpr double kCertain = 1.0;  ///< s without it, from which on it is a fault: a vehicle may fall off a curb

  /// The sample to process. `state`: the filter's, before it; `noise`: the accelerometer's, m/s^2/sqrt(Hz).
  [[nodiscard]] base::ImuSample usable(base::ImuSample sample, const model::NavState& state,
                                       const model::Geometry& geometry, double noise);
  /// Call it where the state is another from one sample to the next.
  void interrupt() { utime_.reset(); }
  /// It is not used at present.
  [[nodiscard]] bool replaced() const { return replaced_for_ > 0.0; }
  /// It has not been used for kCertain.
  [[nodiscard]] bool wrong() const { return replaced_for_ >= kCertain; }
  /// m/s^2, up, that it shows in excess: mean of the last second or so.
  [[nodiscard]] double excess() const { return excess_; }

 private:
  [[nodiscard]] bool judge(double excess, double dt, double noisy, double speed);

  std::optional<std::int64_t> utime_;  // us, of the sample before
  double bias_ = 0.0;                  // m/s^2
  double known_for_ = 0.0;             // s, for which the bias has been averaged
  double speed_ = 0.0;                 // m/s, integral of the excess
  double excess_ = 0.0;                // m/s^2
  double replaced_for_ = 0.0;          // s
};

}  // namespace curbstone::ekf::filter
