#pragma once

#include <string>

namespace curbstone {

/// Throws ConfigError for a key that occurs twice in a map of the YAML text: "ugv.yaml:9: mapper.mode: stands in line 4
/// already". yaml-cpp keeps both and finds the first, so the second would have no effect. `name` stands for the file.
/// Text that is not YAML throws YAML::ParserException.
void refuse_duplicate_keys(const std::string& text, const std::string& name);

}  // namespace curbstone
