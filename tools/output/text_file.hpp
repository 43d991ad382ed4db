#pragma once

#include <filesystem>
#include <string_view>

namespace curbstone::output {

/// Writes `text` as the whole of `file`, which is replaced only when all of it is on the disk; what is no regular file
/// (/dev/stdout, a named pipe) is written to as it is. Throws std::runtime_error with one line that names the file and
/// the cause.
void write_text(const std::filesystem::path& file, std::string_view text);

}  // namespace curbstone::output
