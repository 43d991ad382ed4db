#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace curbstone::imu {

/// Checks the plausibility of an IMU's measurements: detects sensors that are stuck, at the end of their range, or
/// wrong in scale. Pure; frame imu, SI units, times in us on one clock. One thread.
///
/// The limits come from data sheets and from the limits of vehicles, not from recordings:
/// - An accelerometer is never constant: an MTi sends its noise in float32; a WitMotion has steps of 4.8 mm/s^2, and
///   the noise of an MPU-9250 (300 ug/sqrt(Hz), PS-MPU-9250A-01) is 8 mm/s^2 behind its narrowest filter of 5 Hz. A
///   chip with a quarter of that noise may show the same value for a second. So the accelerometer is stuck if three
///   axes are bit for bit the same for 2 s, two for 3 s, or one for 10 s, or one for 3 s in which the others show
///   motion (1 m/s^2 within each second).
/// - A gyro may be constant: a WitMotion's steps are 1.07 mrad/s, and it sets small values to zero. An axis is stuck if
///   it shows the same rate for 0.5 s, and a rate that no bias explains (0.1 rad/s: 5.7 deg/s; an MPU-9250's bias is at
///   most 5): no vehicle keeps its turn to a hundredth for that long. The whole gyro is stuck if all axes are, or if
///   all are the same for 3 s in which the accelerometer shows motion. A rate at the end of the range is a constant
///   rate, too.
/// - All six values of a device with fine steps (an MTi's float32 and fixed point) are never the same in two samples.
/// It
///   repeats one sample if they are for 50 ms and 5 samples.
/// - The mean specific force over 3 s is between 0.8 and 1.45 g: less is a fall of 9 m, more is a horizontal
///   acceleration of 1.05 g, beyond what tyres hold.
class Plausibility {
 public:
  enum class Verdict { kGood, kFrozen, kStuckAccelerometer, kStuckGyro, kNotGravity };
  struct Name {
    std::string_view counter;
    std::string_view fault;
  };

  /// `time` of the sample; if it goes back or leaps by more than kPause, everything restarts. `fine_steps`: no two
  /// samples of this device are equal.
  Verdict judge(std::int64_t time, const std::array<double, 3>& acceleration, const std::array<double, 3>& rate,
                bool fine_steps = false);
  [[nodiscard]] static Name name(Verdict verdict);
  /// Axes of the gyro that are stuck as of the latest sample while the gyro as a whole is not: the others are good.
  [[nodiscard]] const std::array<bool, 3>& stuck_axes() const { return stuck_axes_; }

 private:
  /// How long, and for how many samples, a value has been the same.
  struct Held {
    double value = 0;
    std::int64_t since = 0;
    int samples = 0;
    void add(std::int64_t time, double now);
    [[nodiscard]] bool lasts(std::int64_t time, std::int64_t us, int least = kMinEqual) const;
    static constexpr int kMinEqual = 20;  // equal samples: a slow device needs more time
  };
  void begin(std::int64_t time);
  void end_second(std::int64_t time);
  /// Whether all six values have been the same.
  [[nodiscard]] bool frozen(std::int64_t time) const;
  /// Whether the accelerometer has shown motion for some seconds.
  [[nodiscard]] bool moves() const;
  [[nodiscard]] static bool all_last(const std::array<Held, 3>& axes, std::int64_t time, std::int64_t us);
  [[nodiscard]] bool accelerometer_stuck(std::int64_t time) const;
  [[nodiscard]] bool gyro_stuck(std::int64_t time) const;

  std::int64_t last_ = 0;
  std::array<Held, 3> acceleration_;
  std::array<Held, 3> rate_;
  std::array<bool, 3> stuck_axes_{};

  std::int64_t second_ = 0;  // begin of the current second
  int samples_ = 0;
  std::array<double, 3> sum_{}, least_{}, most_{};
  std::vector<std::array<double, 3>> means_;  // of the latest seconds, at most three
  int moving_ = 0;                            // consecutive seconds with motion
  bool gravity_ = true;
};

}  // namespace curbstone::imu
