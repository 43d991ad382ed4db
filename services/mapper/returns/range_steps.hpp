#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "services/mapper/returns/verdict.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::returns {

/// Detects ranges that come in coarse steps: a wrong unit, or a device that rounds. Sound devices have steps of 0.2 to
/// 4 cm.
///
/// The ranges of one laser, sorted, differ by nothing or by a multiple of the step. Ranges without a step differ by
/// anything: in a revolution a quarter of their differences is near a multiple of whichever step. An offset of each
/// laser, and coordinates that are rounded to 2 mm, do not matter. Status only. A function of the scans alone. Pure;
/// one thread. Counters: faults.lidar.range_steps (times that it began).
class RangeSteps {
 public:
  static constexpr int kEvery = 20;         ///< revolutions per look
  static constexpr int kLooks = 3;          ///< in a row
  static constexpr float kCoarse = 0.045F;  ///< m: a fault from here on

  /// To be called for each revolution, in lidar.
  void check(const scan::Scan& scan);
  /// m; nothing if the ranges are sound.
  [[nodiscard]] std::optional<double> step() const;
  void add_faults(std::vector<std::string>& faults) const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  int revolution_ = 0;
  Verdict verdict_{kLooks, kLooks};
  double step_ = 0;  // m, of the last look that showed one
  Counters counters_;
};

}  // namespace curbstone::mapper::returns
