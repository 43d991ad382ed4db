#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tools/bench/mapping/drives/mapping_drive.hpp"
#include "tools/bench/mapping/increment_consistency.hpp"
#include "tools/bench/mapping/methods/mapping_method.hpp"

namespace curbstone::bench::mapping {

/// What one method came to on one drive.
struct MappingResult {
  std::string name, method, prior;
  evaluate::truth::TrajectoryErrors errors;
  Nees nees;  ///< of increments over half a second, as a filter takes them; none of a method that claims nothing
  double ms_median = 0, ms_p95 = 0;          ///< of a revolution, by the clock on the wall
  double ms_max = 0;                         ///< likewise: where a loop is closed, or a drive begins
  double cpu_ms_median = 0, cpu_ms_p95 = 0;  ///< CPU of the whole process meanwhile: the machine may be shared
  double memory_mb = 0;                      ///< most that the heap had grown by since the method was made (glibc only)
  int revolutions = 0;                       ///< played
  int poses = 0;                             ///< found
  methods::MapContent content;
  int rearranged = 0;                ///< times that the method put right what it had said before
  double corrected_m = 0;            ///< ATE of the drive's poses as it has them at the end; 0 if it never changes them
  evaluate::truth::PosePairs track;  ///< at the truth's stamps
};

/// What is known after a revolution.
struct MappingMoment {
  std::optional<evaluate::truth::StampedPose> pose;      ///< that the method found
  std::optional<evaluate::truth::StampedPose> odometry;  ///< T_odom_base at the revolution's end
  double held_mb = 0;                                    ///< what the heap has grown by since the method was made
  double cpu_ms = 0;                                     ///< that it took
  const mapper::scan::Scan* scan = nullptr;              ///< while the watch is called
};

[[nodiscard]] MappingResult run_mapping(const drives::MappingDrive& drive, const std::string& method,
                                        const std::vector<std::string>& settings,
                                        const std::function<void(const MappingMoment&)>& watch = {});

}  // namespace curbstone::bench::mapping
