#include "tools/bench/mapping/mapping_report.hpp"

#include <fmt/format.h>

#include "tools/output/text_file.hpp"

namespace curbstone::bench::mapping {

std::string mapping_heading() {
  return fmt::format("{:<16} {:<8} {:<6} {:>7} {:>8} {:>7} {:>7} {:>6} {:>14} {:>14} {:>8} {:>9}\n", "drive", "method",
                     "prior", "t_rel %", "deg/m", "ATE m", "end %", "NEES", "ms med/p95", "CPU med/p95", "MB", "poses");
}

std::string mapping_line(const MappingResult& r) {
  const evaluate::truth::TrajectoryErrors& e = r.errors;
  return fmt::format("{:<16} {:<8} {:<6} {:>7.3f} {:>8.4f} {:>7.3f} {:>7.3f} {:>6} {:>14} {:>14} {:>8.1f} {:>9}\n",
                     r.name, r.method, r.prior, e.rpe_percent, e.rpe_deg_per_m, e.ate_m, e.end_percent,
                     r.nees.increments > 0 ? fmt::format("{:.1f}", r.nees.all) : "-",
                     fmt::format("{:.1f}/{:.1f}", r.ms_median, r.ms_p95),
                     fmt::format("{:.1f}/{:.1f}", r.cpu_ms_median, r.cpu_ms_p95), r.memory_mb,
                     fmt::format("{}/{}", r.poses, r.revolutions));
}

std::string mapping_maps(const std::vector<MappingResult>& results) {
  std::string text = fmt::format("{:<16} {:<8} {:<6} {:>10} {:>10} {:>8} {:>14}\n", "map of", "method", "prior",
                                 "points", "points/m2", "MB", "local elements");
  for (const MappingResult& r : results) {
    const auto points = static_cast<double>(r.content.points);
    const double density = r.content.square_metres > 0 ? points / r.content.square_metres : 0;
    text += fmt::format("{:<16} {:<8} {:<6} {:>10} {:>10.0f} {:>8.2f} {:>14}\n", r.name, r.method, r.prior,
                        r.content.points, density, points * r.content.bytes_per_point / 1e6, r.content.local_elements);
  }
  return text;
}

void write_mapping_track(const MappingResult& result, const std::string& folder) {
  const std::string file = fmt::format("{}/{}-{}-{}.csv", folder, result.name, result.method, result.prior);
  std::string rows = "true_x,true_y,true_z,true_qw,true_qx,true_qy,true_qz,x,y,z,qw,qx,qy,qz\n";
  for (std::size_t i = 0; i < result.track.truth.size(); ++i) {
    double p[2][3], q[2][4];
    pose_to_arrays(result.track.truth[i], p[0], q[0]);
    pose_to_arrays(result.track.estimate[i], p[1], q[1]);
    rows += fmt::format("{:.5f},{:.7f},{:.5f},{:.7f}\n", fmt::join(p[0], ","), fmt::join(q[0], ","),
                        fmt::join(p[1], ","), fmt::join(q[1], ","));
  }
  output::write_text(file, rows);
}

nlohmann::json mapping_json(const MappingResult& r) {
  nlohmann::json json = {{"name", r.name},
                         {"method", r.method},
                         {"prior", r.prior},
                         {"t_rel_percent", r.errors.rpe_percent},
                         {"r_rel_deg_per_m", r.errors.rpe_deg_per_m},
                         {"ate_m", r.errors.ate_m},
                         {"end_percent", r.errors.end_percent},
                         {"ms_median", r.ms_median},
                         {"ms_p95", r.ms_p95},
                         {"ms_max", r.ms_max},
                         {"memory_mb", r.memory_mb},
                         {"poses", r.poses},
                         {"revolutions", r.revolutions},
                         {"map_points", r.content.points},
                         {"local_elements", r.content.local_elements}};
  if (r.nees.increments > 0) {
    json["nees"] = r.nees.all;
    json["nees_translation"] = r.nees.translation;
    json["nees_rotation"] = r.nees.rotation;
  }
  return json;
}

void write_runs(const nlohmann::json& runs, const std::string& file) {
  output::write_text(file, nlohmann::json{{"runs", runs}}.dump(2) + "\n");
}

void write_mapping_json(const std::vector<MappingResult>& results, const std::string& file) {
  nlohmann::json runs = nlohmann::json::array();
  for (const MappingResult& result : results) runs.push_back(mapping_json(result));
  write_runs(runs, file);
}

}  // namespace curbstone::bench::mapping
