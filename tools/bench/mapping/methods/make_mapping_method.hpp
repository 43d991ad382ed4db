#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tools/bench/mapping/drives/mapping_drive.hpp"
#include "tools/bench/mapping/methods/mapping_method.hpp"

namespace curbstone::bench::mapping::methods {

/// Names of all methods: ours first, then those of PCL.
[[nodiscard]] std::vector<std::string> mapping_methods();
/// Makes a method for a new drive. `settings`: KEY=VALUE of section mapper, for our methods. Throws ConfigError for an
/// unknown name.
[[nodiscard]] std::unique_ptr<MappingMethod> make_mapping_method(const std::string& name,
                                                                 const drives::MappingDrive& drive,
                                                                 const std::vector<std::string>& settings);

}  // namespace curbstone::bench::mapping::methods
