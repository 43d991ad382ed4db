#pragma once

#include <string>
#include <vector>

#include "tools/bench/mapping/mapping_drive.hpp"
#include "tools/bench/mapping/mapping_method.hpp"

namespace curbstone {

/// What one method came to on one drive.
struct MappingResult {
  std::string name, method, prior;
  TrajectoryErrors errors;
  double ms_median = 0, ms_p95 = 0;          ///< of a revolution, by the clock on the wall
  double cpu_ms_median = 0, cpu_ms_p95 = 0;  ///< CPU of the whole process meanwhile: the machine may be shared
  double memory_mb = 0;                      ///< most heap that the method held after a revolution (glibc only, else 0)
  int revolutions = 0;                       ///< played
  int poses = 0;                             ///< found
  MapContent content;
  PosePairs track;  ///< at the truth's stamps
};

[[nodiscard]] MappingResult run_mapping(const MappingDrive& drive, const std::string& method,
                                        const std::vector<std::string>& settings);

}  // namespace curbstone
