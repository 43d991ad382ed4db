#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tools/bench/mapping/drives/mapping_drive.hpp"
#include "tools/bench/mapping/methods/mapping_method.hpp"

namespace curbstone::bench::mapping::methods {

/// Names of all methods: ours first, then the peers.
[[nodiscard]] std::vector<std::string> mapping_methods();
/// A fresh one for a drive. `settings`: KEY=VALUE of section mapper, for ours. Throws ConfigError for a wrong name.
[[nodiscard]] std::unique_ptr<MappingMethod> make_mapping_method(const std::string& name,
                                                                 const drives::MappingDrive& drive,
                                                                 const std::vector<std::string>& settings);

}  // namespace curbstone::bench::mapping::methods
