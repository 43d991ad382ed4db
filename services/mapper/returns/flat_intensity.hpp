#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "services/mapper/returns/verdict.hpp"
#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::returns {

/// Detects intensities that have become one and the same: no markings are found from there on. A device that never
/// measured any is not reported. Status only. A function of the scans alone. Pure; one thread.
/// Counters: faults.lidar.intensity (times that it began).
class FlatIntensity {
 public:
  static constexpr int kVaried = 100;              ///< revolutions with different intensities before
  static constexpr int kLooks = 40;                ///< revolutions in a row
  static constexpr std::size_t kMinReturns = 400;  ///< of a revolution

  /// To be called for each revolution.
  void check(const scan::Scan& scan);
  void add_faults(std::vector<std::string>& faults) const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  int varied_ = 0;  // revolutions, up to kVaried
  int value_ = 0;
  Verdict verdict_{kLooks, kLooks};
  Counters counters_;
};

}  // namespace curbstone::mapper::returns
