#pragma once

#include "tools/bench/mapping/drives/loop_drive.hpp"
#include "tools/bench/mapping/mapping_run.hpp"

namespace curbstone::bench::mapping {

/// How far off a pose was, when the first pose and the truth's coincide.
struct LoopError {
  double way_m = 0;     ///< driven until then
  double error_m = 0;   ///< of position
  double height_m = 0;  ///< of it, the part along z
  [[nodiscard]] double percent() const { return way_m > 0 ? 100.0 * error_m / way_m : 0.0; }
};

/// After each round of a drive that goes on.
struct LapFigures {
  int lap = 0;
  LoopError error;
  double held_mb = 0;      ///< what the heap has grown by since the method was made
  double resident_mb = 0;  ///< of the whole process, the simulator's town included
  double cpu_ms = 0;       ///< a revolution of this lap, mean
};

struct LoopResult {
  MappingResult run;
  LoopError before;           ///< when it comes back: what drifted on the way
  LoopError end;              ///< at the end: after closing the loop, if the method does
  LoopError odometry_before;  ///< of odometry alone
  LoopError odometry_end;
  double mapping_cpu_s = 0;  ///< of the whole drive
  std::vector<LapFigures> laps;
};

/// `lap_done`: after each round, as it comes.
[[nodiscard]] LoopResult run_loop(const drives::LoopDrive& drive, const std::string& method,
                                  const std::vector<std::string>& settings,
                                  const std::function<void(const LapFigures&)>& lap_done = {});

[[nodiscard]] std::string loop_heading();
[[nodiscard]] std::string loop_line(const LoopResult& result);
[[nodiscard]] std::string lap_line(const LapFigures& lap);
/// As write_mapping_json() with what loop_line() and lap_line() say on top.
void write_loop_json(const std::vector<LoopResult>& results, const std::string& file);

}  // namespace curbstone::bench::mapping
