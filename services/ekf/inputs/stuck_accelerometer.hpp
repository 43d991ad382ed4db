#pragma once

#include <array>
#include <cstdint>

#include "services/ekf/base/samples.hpp"

namespace curbstone::ekf::inputs {

/// Detects an accelerometer of which one axis or all are stuck: the axis shows the same force, bit for bit, for kRun
/// samples or more while the wheels drive the vehicle by kWay. Noise and the road make that impossible in a healthy
/// axis; at a standstill a coarse accelerometer may well repeat itself. The accelerometer is trusted again when each
/// axis has changed within every kRun samples for kTrust.
///
/// A value type; one thread. Samples of each sensor in the order of their stamps.
class StuckAccelerometer {
 public:
  static constexpr int kRun = 50;                    ///< samples
  static constexpr double kWay = 0.3;                ///< m
  static constexpr std::int64_t kTrust = 2'000'000;  ///< us

  explicit StuckAccelerometer(double wheel_radius) : wheel_radius_(wheel_radius) {}

  void add(const base::WheelSample& sample);
  /// Adds a sample. Returns whether any axis is stuck as of this sample.
  bool add(const base::ImuSample& sample);
  [[nodiscard]] bool stuck() const { return stuck_[0] || stuck_[1] || stuck_[2]; }
  /// By axis of the IMU.
  [[nodiscard]] const std::array<bool, 3>& axes() const { return stuck_; }

 private:
  struct Axis {
    double shown = 0.0;      // m/s^2
    int repeats = 0;         // samples in a row
    double since = 0.0;      // m, distance driven at the first of them
    std::int64_t moved = 0;  // us, since when it has changed without a long run
  };

  double wheel_radius_;  // m
  double way_ = 0.0;     // m, distance driven by the wheel that went less
  std::array<double, 2> angle_ = {};
  bool has_wheels_ = false;
  bool has_imu_ = false;
  std::array<Axis, 3> axis_ = {};
  std::array<bool, 3> stuck_ = {};
};

}  // namespace curbstone::ekf::inputs
