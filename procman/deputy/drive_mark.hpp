#pragma once

#include <string>

namespace curbstone::procman::deputy {

/// Whether `file`, which is written to each second while a drive goes on and removed at its end, says that somebody was
/// killed in mid-drive within the last 20 s (as mapper.resume_within_s), by the host's clock. False where there is
/// none.
[[nodiscard]] bool is_of_broken_off_drive(const std::string& file);

}  // namespace curbstone::procman::deputy
