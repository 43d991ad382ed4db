#pragma once

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "tests/services/ekf/simulated_drive.hpp"

namespace curbstone::ekf {

/// What goes wrong with the wheels' counts, and stays so.
struct WheelFault {
  std::string name;
  std::array<double, 2> gain = {1, 1};  ///< of the counts, left and right: 0 frozen, -1 wrong sign, 2 doubled
  double step = 0;                      ///< rad, by which the left count leaps every `every` s
  double every = 1;                     ///< s
  /// They can be recognised in a drive. A tenth on both wheels, and short leaps, cannot.
  [[nodiscard]] bool of_both_wheels() const { return gain[0] == gain[1] && std::abs(gain[0] - 1) > 0.2; }
  [[nodiscard]] bool of_one_wheel() const { return gain[0] != gain[1]; }
};

/// All that are tried.
[[nodiscard]] const std::vector<WheelFault>& tried_wheel_faults();

/// The drive with the fault from `onset` s on.
[[nodiscard]] Drive with_fault(Drive drive, const WheelFault& fault, double onset);

}  // namespace curbstone::ekf
