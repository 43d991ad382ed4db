#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/bench/mapping/mapping_run.hpp"

namespace curbstone::bench::mapping {

[[nodiscard]] std::string mapping_heading();
[[nodiscard]] std::string mapping_line(const MappingResult& result);
/// Compares the maps of all methods on each drive: points, density, bytes.
[[nodiscard]] std::string mapping_maps(const std::vector<MappingResult>& results);
/// Writes the poses behind the figures: DRIVE-METHOD-PRIOR.csv in a folder, truth and estimate side by side. Throws
/// std::runtime_error.
void write_mapping_track(const MappingResult& result, const std::string& folder);
/// One run as an element of the file of write_runs().
[[nodiscard]] nlohmann::json mapping_json(const MappingResult& result);
/// Writes {"runs": [...]}, the source of the tables of docs/benchmarks. The file is written atomically. Throws
/// std::runtime_error.
void write_runs(const nlohmann::json& runs, const std::string& file);
void write_mapping_json(const std::vector<MappingResult>& results, const std::string& file);

}  // namespace curbstone::bench::mapping
