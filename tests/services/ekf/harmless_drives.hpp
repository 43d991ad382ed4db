#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/services/ekf/simulated_drive.hpp"

namespace curbstone::ekf {

/// A drive whose wheels are as they should be, though much else is not.
struct HarmlessDrive {
  std::string name;
  std::function<Drive()> make;
  double spin_ends = -1.0;  ///< s, when wheels that spin or slide for seconds have grip again; negative: none does
};

/// Radii and tracks that the configuration has wrong, skidding turns, stamps that jitter, ice, a jack.
[[nodiscard]] const std::vector<HarmlessDrive>& harmless_drives();

}  // namespace curbstone::ekf
