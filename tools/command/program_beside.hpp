#pragma once

#include <filesystem>
#include <string_view>

namespace curbstone::command {

/// The folder of the running program, with symbolic links resolved.
[[nodiscard]] std::filesystem::path own_folder();

/// Replaces this process by the program curbstone-NAME of `folder`, with the same arguments. Returns only on failure:
/// prints the reason and returns the exit status. PATH is not searched, so the version is that of this build.
int exec_program(std::string_view name, const std::filesystem::path& folder, char** argv);

}  // namespace curbstone::command
