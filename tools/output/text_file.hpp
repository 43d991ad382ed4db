#pragma once

#include <filesystem>
#include <string_view>

namespace curbstone::output {

/// Writes `text` as the whole content of `file`, which is replaced only once all of it is on the disk. Anything but a
/// regular file (/dev/stdout, a named pipe) is written directly. Throws std::runtime_error with a one-line message that
/// names the file and the cause.
void write_text(const std::filesystem::path& file, std::string_view text);

}  // namespace curbstone::output
