#pragma once

#include <string>
#include <vector>

#include "common/config/config.hpp"

namespace curbstone {

/// What is said of a key that a map does not know, "unknown key; did you mean imu.gyro_bias?": the keys of that name in
/// other sections of the `config`, whose path is `root` ("ekf."), else the one of the `known` that is spelt most alike.
[[nodiscard]] std::string unknown_key(const std::string& key, const std::vector<std::string>& known,
                                      const std::string& root, AnyConfig& config);
/// The same, where there is but one map.
[[nodiscard]] std::string unknown_key(const std::string& key, const std::vector<std::string>& known);

}  // namespace curbstone
