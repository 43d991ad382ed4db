#pragma once

#include <string>

namespace curbstone {

/// "<version>+<git commit>".
[[nodiscard]] std::string version();

}  // namespace curbstone
