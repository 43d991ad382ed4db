#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace curbstone::output {

/// Throws std::runtime_error if `out` is one of a command's input files, under any name: writing it would destroy the
/// input, which may be the only recording of a drive.
void refuse_to_overwrite(const std::vector<std::string>& inputs, const std::filesystem::path& out);

}  // namespace curbstone::output
