#pragma once

#include <string>

namespace curbstone::simulate::recorded {

/// The content of a file. Throws std::runtime_error if it cannot be read.
[[nodiscard]] std::string file_bytes(const std::string& file);

}  // namespace curbstone::simulate::recorded
