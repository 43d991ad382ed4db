#include "tools/command/program_beside.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>

namespace curbstone::command {

std::filesystem::path own_folder() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path();
}

int exec_program(std::string_view name, const std::filesystem::path& folder, char** argv) {
  const std::string target = fmt::format("curbstone-{}", name);
  const std::filesystem::path program = folder / target;
  execv(program.c_str(), argv);
  const int error = errno;
  if (error == ENOENT) {
    fmt::print(stderr, "curbstone {}: {} is not there: scripts/build release {}\n", name, program.native(), target);
  } else {
    fmt::print(stderr, "curbstone {}: {} cannot be run: {}\n", name, program.native(), std::strerror(error));
  }
  return 1;
}

}  // namespace curbstone::command
