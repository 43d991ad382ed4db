#pragma once

#include <string>
#include <vector>

#include "common/config/config.hpp"

namespace curbstone {

/// The error text for a key that a map does not know, "unknown key; did you mean imu.gyro_bias?". It suggests the keys
/// of that name in other sections of `config`, whose path is `root` ("ekf."); if there are none, the key in `known`
/// with the most similar spelling.
[[nodiscard]] std::string unknown_key(const std::string& key, const std::vector<std::string>& known,
                                      const std::string& root, AnyConfig& config);
/// The same for a single map.
[[nodiscard]] std::string unknown_key(const std::string& key, const std::vector<std::string>& known);

/// Whether a struct has a section of this name at its top level.
[[nodiscard]] bool has_section(AnyConfig& config, const std::string& name);

}  // namespace curbstone
