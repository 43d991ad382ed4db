#pragma once

#include <string>
#include <string_view>

namespace curbstone {

/// Throws ConfigError for text that yaml-cpp would read as something else than the editor shows: lines that end with a
/// carriage return alone, of which a comment swallows the rest of the file, and zero bytes, as a power cut leaves.
/// UTF-16 and UTF-32 are exempt. `name` is the file, for the error.
void refuse_odd_text(std::string_view text, const std::string& name);

/// What may be behind a `message` of yaml-cpp about the line, which counts from 0 and is negative if the parser does
/// not know it: ": indent by spaces, not by a tab". Empty if nothing is known.
[[nodiscard]] std::string syntax_advice(std::string_view text, int line, const std::string& message);

}  // namespace curbstone
