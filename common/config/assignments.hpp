#pragma once

#include <string>
#include <vector>

#include "common/config/config.hpp"

namespace curbstone {

/// Resolves the assignments SECTION.KEY=VALUE of a command that starts several processes with these `sections`. An
/// assignment to `vehicle`, which the processes share, becomes one assignment for each process. Throws ConfigError if
/// an assignment has no section or one that is not in `sections`, because it would have no effect.
[[nodiscard]] std::vector<std::string> assignments_for(SectionNames sections,
                                                       const std::vector<std::string>& assignments);

}  // namespace curbstone
