#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "services/ekf/base/samples.hpp"

namespace curbstone::ekf::inputs {

/// IMU samples that stand alone: one or two that leap away from those before, and the next is back. A vehicle does not
/// do that; a bit that flipped past an 8-bit checksum, a loose plug and a spark do. A single one of 6 rad/s turns the
/// heading by 3 deg.
///
/// A sample that leaps is kept back until the next one shows whether it stands alone. What goes on, as a jolt does, is
/// let through whole. A leap is kLeaps times what samples usually change by, from one to the next, and no less than
/// kLeastTurn or kLeastForce: jolts of less than that do no harm, nor do bad samples. A value type; one thread.
class LoneSamples {
 public:
  static constexpr double kLeaps = 8.0;
  static constexpr double kLeastTurn = 0.5;          ///< rad/s
  static constexpr double kLeastForce = 25.0;        ///< m/s^2
  static constexpr std::size_t kMost = 2;            ///< samples that may stand alone together
  static constexpr std::int64_t kMostGap = 100'000;  ///< us between samples that can be compared
  static constexpr double kMemory = 1.0;             ///< s, of what is usual

  /// The next sample. Returns those to go on with, in order: none while it may stand alone, up to kMost + 1 when what
  /// was kept back does not. Valid until the next call.
  const std::vector<base::ImuSample>& add(const base::ImuSample& sample);
  /// Samples that stood alone, ever.
  [[nodiscard]] std::int64_t refused() const { return refused_; }
  /// Of these, in the last minute before the newest sample.
  [[nodiscard]] std::size_t lately() const { return lately_.size(); }

 private:
  [[nodiscard]] bool leaps(const base::ImuSample& from, const base::ImuSample& to) const;
  void learn(const base::ImuSample& from, const base::ImuSample& to);
  void refuse_kept();
  void pass(const base::ImuSample& sample);

  std::optional<base::ImuSample> last_;  // that went on
  std::vector<base::ImuSample> kept_;    // may stand alone
  std::vector<base::ImuSample> passed_;
  double turn_ = 0.0;   // (rad/s)^2, mean square of what samples change by
  double force_ = 0.0;  // (m/s^2)^2
  std::int64_t refused_ = 0;
  std::vector<std::int64_t> lately_;  // us, stamps
};

}  // namespace curbstone::ekf::inputs
