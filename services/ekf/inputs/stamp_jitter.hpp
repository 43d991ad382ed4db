#pragma once

#include <array>
#include <cstddef>

#include "services/ekf/base/ekf_config.hpp"
#include "services/ekf/base/samples.hpp"

namespace curbstone::ekf::inputs {

/// Measures the jitter of the wheels' stamps from the wheels themselves: a vehicle moves evenly over some samples, so
/// its travel shows when a sample was taken between its neighbours. Stamps of a busy host are off by milliseconds.
/// Uneven sampling and lost samples are not jitter, if each stamp is the time of sampling.
///
/// Pure; one thread.
class StampJitter {
 public:
  StampJitter(const base::WheelsConfig& config, double wheel_radius) : config_(config), radius_(wheel_radius) {}

  /// Adds the next sample, with a later stamp.
  void add(const base::WheelSample& sample);
  /// Call it where samples are missing. What has been learnt is kept.
  void interrupt() { known_ = 0; }

  /// s, 1 sigma of a stamp over the last kMemory samples; 0 where the jitter is too small to be measured.
  [[nodiscard]] double sigma() const;

  static constexpr int kMemory = 50;  ///< samples

 private:
  static constexpr std::size_t kPoints = 4;
  /// s, the stamp error of the second of the samples, and its noise from other causes.
  struct Error {
    double off = 0.0;
    double noise = 0.0;
  };
  [[nodiscard]] bool evaluate(std::size_t wheel, Error& error) const;

  base::WheelsConfig config_;
  double radius_;  // m
  std::array<base::WheelSample, kPoints> samples_{};
  std::size_t known_ = 0;  // number of valid samples, at the array's end
  int learnt_ = 0;         // number of samples, at most kMemory
  double mean_off_ = 0.0;  // s, mean magnitude of the errors
  double mean_noise_ = 0.0;
};

}  // namespace curbstone::ekf::inputs
