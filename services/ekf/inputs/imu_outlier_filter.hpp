#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "services/ekf/base/samples.hpp"

namespace curbstone::ekf::inputs {

/// Filters out isolated IMU samples: one or two that leap away from those before, after which the next one is back. A
/// vehicle does not move like that; the causes are a flipped bit that passes an 8-bit checksum, a loose plug or a
/// spark. A single sample of 6 rad/s turns the heading by 3 deg.
///
/// A sample that leaps is held until the next one shows whether it is isolated. If the signal stays there, as in a
/// jolt, all held samples are passed on. A leap is a change of kLeaps times the usual change from one sample to the
/// next, and at least kMinTurn or kMinForce: smaller bad samples do no harm. A value type; one thread.
class ImuOutlierFilter {
 public:
  static constexpr double kLeaps = 8.0;
  static constexpr double kMinTurn = 0.5;           ///< rad/s
  static constexpr double kMinForce = 25.0;         ///< m/s^2
  static constexpr std::size_t kMaxIsolated = 2;    ///< samples that may be isolated together
  static constexpr std::int64_t kMaxGap = 100'000;  ///< us, longest gap between samples that can be compared
  static constexpr double kMemory = 1.0;            ///< s, over which the usual change is averaged

  /// Adds the next sample. Returns the samples to process, in order: none while the sample may be isolated; those that
  /// were held, too, when they are released. Valid until the next call.
  const std::vector<base::ImuSample>& add(const base::ImuSample& sample);
  /// Number of isolated samples since the start.
  [[nodiscard]] std::int64_t refused() const { return refused_; }
  /// Number of isolated samples in the last minute before the newest sample.
  [[nodiscard]] std::size_t rejected_last_minute() const { return recently_rejected_.size(); }

 private:
  [[nodiscard]] bool leaps(const base::ImuSample& from, const base::ImuSample& to) const;
  void learn(const base::ImuSample& from, const base::ImuSample& to);
  void reject_held();
  void pass(const base::ImuSample& sample);

  std::optional<base::ImuSample> last_;  // latest sample that was passed on
  std::vector<base::ImuSample> held_;    // held: may be isolated
  std::vector<base::ImuSample> passed_;
  double turn_ = 0.0;   // (rad/s)^2, mean square change from sample to sample
  double force_ = 0.0;  // (m/s^2)^2
  std::int64_t refused_ = 0;
  std::vector<std::int64_t> recently_rejected_;  // us, stamps
};

}  // namespace curbstone::ekf::inputs
