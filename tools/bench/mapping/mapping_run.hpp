#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tools/bench/mapping/drives/mapping_drive.hpp"
#include "tools/bench/mapping/increment_consistency.hpp"
#include "tools/bench/mapping/methods/mapping_method.hpp"

namespace curbstone::bench::mapping {

/// Figures of one method on one drive.
struct MappingResult {
  std::string name, method, prior;
  evaluate::truth::TrajectoryErrors errors;
  Nees nees;  ///< of increments over 0.5 s, as a filter takes them; none for a method without a covariance
  double ms_median = 0, ms_p95 = 0;          ///< per revolution, wall time
  double ms_max = 0;                         ///< likewise; reached at a loop closure or at the start of a drive
  double cpu_ms_median = 0, cpu_ms_p95 = 0;  ///< CPU time of the whole process; comparable on a shared machine
  double memory_mb = 0;                      ///< maximum heap growth since the method was constructed (glibc only)
  int revolutions = 0;                       ///< played
  int poses = 0;                             ///< found
  methods::MapContent content;
  int rearranged = 0;                ///< how often the method corrected its earlier poses
  double corrected_m = 0;            ///< ATE of the method's final poses of the drive; 0 if it never corrects them
  evaluate::truth::PosePairs track;  ///< at the truth's stamps
};

/// State after a revolution.
struct MappingMoment {
  std::optional<evaluate::truth::StampedPose> pose;      ///< found by the method
  std::optional<evaluate::truth::StampedPose> odometry;  ///< T_odom_base at the end of the revolution
  double held_mb = 0;                                    ///< growth of the heap since the method was constructed
  double cpu_ms = 0;                                     ///< of this revolution
  const mapper::scan::Scan* scan = nullptr;              ///< valid during the call of the watch
};

[[nodiscard]] MappingResult run_mapping(const drives::MappingDrive& drive, const std::string& method,
                                        const std::vector<std::string>& settings,
                                        const std::function<void(const MappingMoment&)>& watch = {});

}  // namespace curbstone::bench::mapping
