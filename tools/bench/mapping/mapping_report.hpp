#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/bench/mapping/mapping_run.hpp"

namespace curbstone::bench::mapping {

[[nodiscard]] std::string mapping_heading();
[[nodiscard]] std::string mapping_line(const MappingResult& result);
/// How the maps of all methods on each drive compare: points, density, bytes.
[[nodiscard]] std::string mapping_maps(const std::vector<MappingResult>& results);
/// The poses behind the figures: DRIVE-METHOD-PRIOR.csv in a folder, truth and estimate side by side. Throws
/// std::runtime_error.
void write_mapping_track(const MappingResult& result, const std::string& folder);
/// One of the runs in the file.
[[nodiscard]] nlohmann::json mapping_json(const MappingResult& result);
/// {"runs": [...]}: what the tables of docs/benchmarks are made of. The file is there as a whole or not at all. Throws
/// std::runtime_error.
void write_runs(const nlohmann::json& runs, const std::string& file);
void write_mapping_json(const std::vector<MappingResult>& results, const std::string& file);

}  // namespace curbstone::bench::mapping
