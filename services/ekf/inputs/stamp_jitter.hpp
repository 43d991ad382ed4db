#pragma once

#include <array>
#include <cstddef>

#include "services/ekf/base/ekf_config.hpp"
#include "services/ekf/base/samples.hpp"

namespace curbstone::ekf::inputs {

/// How much the wheels' stamps jitter, by the wheels themselves: a vehicle goes on evenly for some samples, so its
/// travel says when a sample was taken between its neighbours. Stamps that a busy host made are off from that by
/// milliseconds. Samples that are taken unevenly, or are lost, and are stamped as taken, are not.
///
/// Pure; one thread.
class StampJitter {
 public:
  StampJitter(const base::WheelsConfig& config, double wheel_radius) : config_(config), radius_(wheel_radius) {}

  /// The next sample, with a later stamp.
  void add(const base::WheelSample& sample);
  /// The samples were interrupted. What has been learnt stays.
  void interrupt() { known_ = 0; }

  /// s, 1 sigma of a stamp, as far as it has shown within the last kMemory samples; 0 where the stamps are as good as
  /// can be measured.
  [[nodiscard]] double sigma() const;

  static constexpr int kMemory = 50;  ///< samples

 private:
  static constexpr std::size_t kPoints = 4;
  /// s, by which the second of the samples is off, and what else than its stamp may put it off by.
  struct Error {
    double off = 0.0;
    double noise = 0.0;
  };
  [[nodiscard]] bool evaluate(std::size_t wheel, Error& error) const;

  base::WheelsConfig config_;
  double radius_;  // m
  std::array<base::WheelSample, kPoints> samples_{};
  std::size_t known_ = 0;  // of them, at their end
  int learnt_ = 0;         // samples, up to kMemory
  double mean_off_ = 0.0;  // s, of the errors' magnitudes
  double mean_noise_ = 0.0;
};

}  // namespace curbstone::ekf::inputs
