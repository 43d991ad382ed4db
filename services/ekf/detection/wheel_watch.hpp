#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "services/ekf/base/ekf_config.hpp"

namespace curbstone::ekf::detection {

/// Wheels that disagree for good: a shaft that is broken, an encoder that is unplugged or counts in other steps. Slip
/// ends (SlipJudge); these do not, so a wheel that is found faulty is withheld until it has agreed for kAgreement.
///
/// - One of the trusted wheels is refused for more than a third of the time: when that adds up to the patience, it is
///   faulty. The filter is held by the others.
/// - All of them are refused for the patience without a break: either they are wrong, or the filter is. Who is shown by
///   how the two came apart. A wheel that is stuck, counts backwards or in other steps shows a multiple of the speed.
///   A filter whose tilt is wrong drifts away, evenly with time. Where the wheels turn otherwise than the gyro, it is
///   the wheels: tilt does not change that. Where the IMU has leapt (a blow), it is the filter.
///
/// Pure; one thread.
class WheelWatch {
 public:
  explicit WheelWatch(const base::SlipConfig& config) : config_(config) {}

  /// An interval of the wheels while the vehicle drives, and what the filter expected of it.
  struct Look {
    std::int64_t begin = 0;               ///< us
    std::int64_t end = 0;                 ///< us
    std::array<double, 2> speed = {};     ///< m/s, of the wheels, left and right
    std::array<double, 2> expected = {};  ///< m/s, of the wheels, by the filter
    std::array<double, 2> sigma = {};     ///< m/s, 1 sigma of their difference
    std::array<bool, 2> refused = {};     ///< the wheel is taken to slip
    bool turning = false;                 ///< the wheels turn otherwise than the gyro
    double inertial_speed = 0.0;          ///< m/s, integral of forward acceleration since any start
  };
  /// Whose fault it is that all wheels have been refused for long, once it is known.
  enum class Finding { kNone, kWheels, kFilter };
  Finding add(const Look& look);
  /// The intervals were interrupted.
  void interrupt();

  [[nodiscard]] bool faulty(std::size_t wheel) const { return wheels_[wheel].faulty; }
  [[nodiscard]] bool all_faulty() const { return faulty(0) && faulty(1); }
  /// The speed that a faulty wheel shows, as a multiple of the true one.
  [[nodiscard]] double ratio(std::size_t wheel) const { return wheels_[wheel].ratio(); }
  /// Wheels without travel prove nothing: all that are trusted are refused while the filter moves, or all are faulty
  /// and one of them does not turn.
  [[nodiscard]] bool hides_motion() const;

  /// m/s by which wheels that were found faulty last may have pulled the filter along before they were refused. Those
  /// that went astray at a stroke have not.
  [[nodiscard]] double pull() const { return pull_; }

  static constexpr double kAgreement = 10.0;  ///< s of driving, after which a wheel is trusted again

 private:
  struct Wheel {
    bool faulty = false;
    double refused = 0.0;    // s, less half of the time in between
    double agreed = 0.0;     // s, since it was found faulty
    double product = 0.0;    // of speed and expected speed, while it is refused; m^2/s
    double expected2 = 0.0;  // of the expected speed with itself
    void weigh(double speed, double expected, double seconds);
    [[nodiscard]] double ratio() const { return expected2 > 0 ? product / expected2 : 1.0; }
  };
  /// All trusted wheels have been refused since `begin`. d: their mean difference from the filter; t: s since then, and
  /// kBefore; v: the filter's speed.
  struct Dispute {
    std::int64_t begin = 0;  // us
    double dd = 0, dt = 0, tt = 0, dv = 0, vv = 0;
    int intervals = 0;
    double turning = 0;       // s
    double wheels_leapt = 0;  // m/s, more than the IMU
    bool imu_leapt = false;
    double first = 0;  // m/s, d
    double speed = 0;  // m/s, the newest
  };
  struct Recent {
    double wheels = 0, inertial = 0;  // m/s
  };

  void judge_alone(Wheel& wheel, bool refused, double seconds) const;
  void judge_faulty(Wheel& wheel, std::size_t i, const Look& look) const;
  Finding dispute(const Look& look);
  void remember(const Look& look);
  [[nodiscard]] Finding settle(const Dispute& d) const;

  base::SlipConfig config_;
  std::array<Wheel, 2> wheels_;
  std::optional<Dispute> dispute_;
  double pull_ = 0;
  std::array<Recent, 3> recent_{};  // newest last
  int remembered_ = 0;
};

}  // namespace curbstone::ekf::detection
