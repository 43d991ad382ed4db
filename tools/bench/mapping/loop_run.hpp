#pragma once

#include "tools/bench/mapping/drives/loop_drive.hpp"
#include "tools/bench/mapping/mapping_run.hpp"

namespace curbstone::bench::mapping {

/// Error of a pose, with the first pose aligned to the truth's.
struct LoopError {
  double way_m = 0;     ///< driven so far
  double error_m = 0;   ///< of position
  double height_m = 0;  ///< its part along z
  [[nodiscard]] double percent() const { return way_m > 0 ? 100.0 * error_m / way_m : 0.0; }
};

/// Figures of each lap of a longer drive.
struct LapFigures {
  int lap = 0;
  LoopError error;
  double held_mb = 0;      ///< growth of the heap since the method was constructed
  double resident_mb = 0;  ///< of the whole process, including the simulator's town
  double cpu_ms = 0;       ///< mean per revolution of this lap
};

struct LoopResult {
  MappingResult run;
  LoopError before;           ///< on return to the start: the accumulated drift
  LoopError end;              ///< at the end: after loop closure, if the method does it
  LoopError odometry_before;  ///< of odometry alone
  LoopError odometry_end;
  double mapping_cpu_s = 0;  ///< of the whole drive
  std::vector<LapFigures> laps;
};

/// `lap_done`: called after each lap.
[[nodiscard]] LoopResult run_loop(const drives::LoopDrive& drive, const std::string& method,
                                  const std::vector<std::string>& settings,
                                  const std::function<void(const LapFigures&)>& lap_done = {});

[[nodiscard]] std::string loop_heading();
[[nodiscard]] std::string loop_line(const LoopResult& result);
[[nodiscard]] std::string lap_line(const LapFigures& lap);
/// As write_mapping_json(), plus the figures of loop_line() and lap_line().
void write_loop_json(const std::vector<LoopResult>& results, const std::string& file);

}  // namespace curbstone::bench::mapping
