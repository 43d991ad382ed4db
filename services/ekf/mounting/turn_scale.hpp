#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace curbstone::ekf::mounting {

/// Fits the wheels' yaw rate as a multiple of the gyro's plus a multiple of the speed (a wheel with a wrong radius,
/// stuck or counting backwards): least squares over a stretch of the drive. A value type; one thread.
class TurnFit {
 public:
  /// Adds means over an interval: m/s, rad/s.
  void add(double seconds, double speed, double wheel_rate, double gyro_rate) {
    const Eigen::Vector3d rates(gyro_rate, speed, wheel_rate);
    products_ += seconds * rates * rates.transpose();
    seconds_ += seconds;
  }
  /// Reduces the weight of earlier intervals.
  void fade(double share) {
    products_ *= share;
    seconds_ *= share;
  }
  [[nodiscard]] double seconds() const { return seconds_; }
  /// rad^2/s, integral of the gyro's squared rate, without the part proportional to the speed.
  [[nodiscard]] double turn() const { return products_(0, 0) - products_(0, 1) * products_(0, 1) / speeds(); }
  /// Likewise for the wheels.
  [[nodiscard]] double wheel_turn() const { return products_(2, 2) - products_(1, 2) * products_(1, 2) / speeds(); }
  /// The multiple of the gyro's rate. Requires some turn.
  [[nodiscard]] double gain() const {
    return (products_(0, 2) - products_(0, 1) * products_(1, 2) / speeds()) / turn();
  }
  /// Share of wheel_turn() that the gyro's rate explains.
  [[nodiscard]] double explained() const { return gain() * gain() * turn() / std::max(wheel_turn(), 1e-12); }

 private:
  [[nodiscard]] double speeds() const { return std::max(products_(1, 1), 1e-9); }

  Eigen::Matrix3d products_ = Eigen::Matrix3d::Zero();  // gyro's rate, speed, wheels' rate
  double seconds_ = 0.0;
};

/// Detects that the wheels turn by another multiple than 1 of the gyro's turn, in all but one of the last stretches of
/// turning: the track width is wrong (that of a skid steer is not the distance of its wheels), or the gyro's scale is.
/// The sensors do not show which. If the gyro does not turn at all the multiple is kGyroNotTurning; if it turns far
/// more than the wheels, kGyroTooFast.
///
/// A gyro that does not turn while the wheels do is right if a wheel slips. A vehicle that turns is accelerated
/// sideways, by its speed times its yaw rate: without that force the stretch does not count.
///
/// A value type; one thread.
class TurnScale {
 public:
  static constexpr double kMaxScaleError = 0.12;  ///< margin for slip and for a track width measured by hand
  static constexpr double kGyroNotTurning = 100.0;
  static constexpr double kGyroTooFast = 0.0;

  /// As TurnFit::add(). `force`: the level part of the specific force, m/s^2, without what is constant, as tilt is.
  void add(double seconds, double speed, double wheel_rate, double gyro_rate, const Eigen::Vector2d& force) {
    check_gyro_too_fast(seconds, speed, wheel_rate, gyro_rate);
    sideways_.add(seconds, speed * wheel_rate, force);
    fit_.add(seconds, speed, wheel_rate, gyro_rate);
    const bool turns = std::max(fit_.turn(), fit_.wheel_turn()) >= kMinTurn;
    if (turns && fit_.seconds() >= kMinSeconds) judge_stretch();
  }
  /// The multiple, if it is wrong.
  [[nodiscard]] std::optional<double> wrong_scale() const {
    if (gain_count_ < kStretches) return {};
    std::array<double, kStretches> sorted = gains_;
    std::sort(sorted.begin(), sorted.end());
    const double least = sorted[1] - 1.0, most = sorted[kStretches - 2] - 1.0;  // of all but one
    if (least < kMaxScaleError && most > -kMaxScaleError) return {};
    return sorted[kStretches / 2];
  }
  /// Whether a wrong track width may explain the multiple.
  [[nodiscard]] static bool is_plausible(double multiple) {
    return std::abs(multiple) > 1 / kMaxScale && std::abs(multiple) < kMaxScale;
  }

 private:
  static constexpr double kMinTurn = 0.05;    // rad^2/s: 9 deg/s for 2 s
  static constexpr double kMinSeconds = 2.0;  // s: slip is shorter than most of the stretches together
  static constexpr double kExplained = 0.9;
  static constexpr double kStill = 0.02;       // of the wheels' square
  static constexpr double kSideways = 0.35;    // of the acceleration that the wheels' turn calls for
  static constexpr double kMinSideways = 0.1;  // m^2/s^3, of that acceleration: 0.3 m/s^2 for a second
  static constexpr std::size_t kStretches = 5;
  static constexpr double kMaxScale = 5.0;
  static constexpr double kTooFast = 0.4;     // rad/s, in addition to kMaxScale times the wheels' rate
  static constexpr double kTooFastFor = 1.0;  // s, for that long
  static constexpr double kDriving = 0.3;     // m/s
  /// Compares the force with the sideways acceleration that the wheels' turn calls for, m/s^2.
  struct Sideways {
    double square = 0.0;  // of that acceleration, integrated over time
    Eigen::Vector2d product = Eigen::Vector2d::Zero();
    void add(double seconds, double by_wheels, const Eigen::Vector2d& force) {
      square += seconds * by_wheels * by_wheels;
      product += seconds * by_wheels * force;
    }
    /// 1 in a turn, 0 in a slip, and where wheels that turn opposite ways call for no force: one may count backwards.
    [[nodiscard]] double share() const { return square < kMinSideways ? 0.0 : product.norm() / square; }
  };

  /// A gyro in another unit exceeds the wheels' yaw rate by far: kTooFastFor of it is enough.
  void check_gyro_too_fast(double seconds, double speed, double wheel_rate, double gyro_rate) {
    const bool too_fast = std::abs(gyro_rate) > kTooFast + kMaxScale * std::abs(wheel_rate);
    too_fast_for_ = too_fast && std::abs(speed) > kDriving && !gyro_turns_ ? too_fast_for_ + seconds : 0.0;
    if (too_fast_for_ <= kTooFastFor) return;
    gains_.fill(kGyroTooFast);
    gain_count_ = kStretches;
  }
  void judge_stretch() {
    const bool gyro_turned = fit_.turn() >= kMinTurn;
    const bool only_wheels_turned = fit_.turn() < kStill * fit_.wheel_turn();
    if (only_wheels_turned && !gyro_turns_) {
      if (sideways_.share() > kSideways) add_gain(kGyroNotTurning);
    } else if (!gyro_turned) {
      return;  // the stretch continues
    } else if (fit_.explained() > kExplained) {
      add_gain(fit_.gain());
      gyro_turns_ = gyro_turns_ || is_plausible(fit_.gain());
    }
    fit_ = {};
    sideways_ = {};
  }
  void add_gain(double gain) {
    std::rotate(gains_.begin(), gains_.begin() + 1, gains_.end());
    gains_.back() = gain;
    gain_count_ = std::min(gain_count_ + 1, kStretches);
  }

  TurnFit fit_;
  Sideways sideways_;
  std::array<double, kStretches> gains_{};
  std::size_t gain_count_ = 0;
  double too_fast_for_ = 0.0;  // s
  bool gyro_turns_ = false;    // the gyro has turned as the wheels do: if they turn without it later, they slip
};

}  // namespace curbstone::ekf::mounting
