#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "procman/sheriff/sheriff.hpp"

namespace curbstone::procman::sheriff {

/// One line a command: state, CPU (% of the whole machine), memory (MB), restarts, ready, age of its SERVICE_STATUS,
/// faults. Ends with a newline. Control characters, which anybody on the bus can send, are shown as '?'.
[[nodiscard]] std::string status_table(const std::map<std::string, Known>& commands, std::int64_t now);

/// Text from the bus that is fit for a terminal.
[[nodiscard]] std::string printable(std::string_view text);

}  // namespace curbstone::procman::sheriff
