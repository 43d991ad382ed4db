#pragma once

#include <string>
#include <vector>

#include "common/config/config.hpp"

namespace curbstone {

/// SECTION.KEY=VALUE for a command that sets up several processes, whose sections these are. One of `vehicle`, which
/// they share, becomes one for each of them. Throws ConfigError where the section is none of these, or there is none:
/// it would change nothing.
[[nodiscard]] std::vector<std::string> assignments_for(SectionNames sections,
                                                       const std::vector<std::string>& assignments);

}  // namespace curbstone
