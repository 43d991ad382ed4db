#pragma once

#include <filesystem>
#include <string_view>

namespace curbstone::command {

/// The folder of the running program, links to it resolved.
[[nodiscard]] std::filesystem::path own_folder();

/// Becomes the program curbstone-NAME of this folder, with the same arguments. Returns only if that fails: the exit
/// status, once the reason has been printed. PATH is not searched, so the version is that of this build.
int exec_program(std::string_view name, const std::filesystem::path& folder, char** argv);

}  // namespace curbstone::command
