#pragma once

#include <string>
#include <string_view>

namespace curbstone::encoder::traces {

/// Of a line that shows that a recording is of a kind which is not read: which kind, and what makes one of it that is.
/// Empty for all other lines.
[[nodiscard]] std::string foreign_recording(std::string_view line);

}  // namespace curbstone::encoder::traces
