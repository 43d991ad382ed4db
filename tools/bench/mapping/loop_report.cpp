#include <fmt/format.h>

#include "tools/bench/mapping/loop_run.hpp"
#include "tools/bench/mapping/mapping_report.hpp"

namespace curbstone::bench::mapping {

std::string loop_heading() {
  return fmt::format("{:<14} {:<8} {:>7} {:>20} {:>8} {:>7} {:>14} {:>9} {:>18} {:>14} {:>8} {:>8} {:>12}\n", "drive",
                     "method", "way m", "back: m (z), %", "t_rel %", "closed", "end: m (z)", "ATE after",
                     "odometry: back end%", "CPU med/p95", "CPU s", "MB", "poses");
}

std::string loop_line(const LoopResult& r) {
  return fmt::format(
      "{:<14} {:<8} {:>7.0f} {:>20} {:>8.3f} {:>7} {:>14} {:>9.3f} {:>18} {:>14} {:>8.0f} {:>8.1f} {:>12}\n",
      r.run.name, r.run.method, r.end.way_m,
      fmt::format("{:.2f} ({:.2f}) {:.3f}", r.before.error_m, r.before.height_m, r.before.percent()),
      r.run.errors.rpe_percent, r.run.rearranged, fmt::format("{:.2f} ({:.2f})", r.end.error_m, r.end.height_m),
      r.run.corrected_m, fmt::format("{:.2f} {:.2f}", r.odometry_before.percent(), r.odometry_end.percent()),
      fmt::format("{:.1f}/{:.1f}", r.run.cpu_ms_median, r.run.cpu_ms_p95), r.mapping_cpu_s, r.run.memory_mb,
      fmt::format("{}/{}", r.run.poses, r.run.revolutions));
}

std::string lap_line(const LapFigures& lap) {
  return fmt::format(
      "  lap {:>3}: {:>7.0f} m, error {:.2f} m ({:.2f} of it in height), mapper {:.1f} MB, process {:.1f} MB, {:.1f} "
      "ms of "
      "CPU a revolution\n",
      lap.lap, lap.error.way_m, lap.error.error_m, lap.error.height_m, lap.held_mb, lap.resident_mb, lap.cpu_ms);
}

void write_loop_json(const std::vector<LoopResult>& results, const std::string& file) {
  nlohmann::json runs = nlohmann::json::array();
  for (const LoopResult& r : results) {
    nlohmann::json run = mapping_json(r.run);
    run["way_m"] = r.end.way_m;
    run["before_m"] = r.before.error_m;
    run["before_percent"] = r.before.percent();
    run["before_height_m"] = r.before.height_m;
    run["closed"] = r.run.rearranged;
    run["end_m"] = r.end.error_m;
    run["end_height_m"] = r.end.height_m;
    run["corrected_ate_m"] = r.run.corrected_m;
    run["odometry_before_percent"] = r.odometry_before.percent();
    run["odometry_percent"] = r.odometry_end.percent();
    run["cpu_ms_median"] = r.run.cpu_ms_median;
    run["cpu_ms_p95"] = r.run.cpu_ms_p95;
    for (const LapFigures& lap : r.laps) {
      run["laps"].push_back({{"lap", lap.lap},
                             {"way_m", lap.error.way_m},
                             {"error_m", lap.error.error_m},
                             {"held_mb", lap.held_mb},
                             {"resident_mb", lap.resident_mb},
                             {"cpu_ms", lap.cpu_ms}});
    }
    runs.push_back(std::move(run));
  }
  write_runs(runs, file);
}

}  // namespace curbstone::bench::mapping
