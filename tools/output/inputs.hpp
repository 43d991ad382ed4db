#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace curbstone::output {

/// Throws std::runtime_error if `out` is one of the files that a command reads, by whatever name: to write it would
/// destroy what is read, and of a drive there may be no other recording.
void refuse_to_overwrite(const std::vector<std::string>& inputs, const std::filesystem::path& out);

}  // namespace curbstone::output
