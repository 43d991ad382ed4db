#pragma once

#include <string>

namespace curbstone {

/// "0.1.0+<git commit>".
[[nodiscard]] std::string version();

}  // namespace curbstone
