#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/terminal/terminal_table.hpp"
#include "procman/sheriff/sheriff.hpp"

namespace curbstone::procman::sheriff {

/// A line of titles and one per command: state, CPU (% of the whole machine), memory (MB), restarts, ready, age of its
/// SERVICE_STATUS, faults.
[[nodiscard]] std::vector<std::string> status_table(const std::map<std::string, CommandInfo>& commands,
                                                    std::int64_t now, const TextStyle& style = {});

}  // namespace curbstone::procman::sheriff
