#include "procman/deputy/command_environment.hpp"

#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

namespace curbstone::procman::deputy {

void prepare_command_environment() {
  std::error_code error;
  const auto own = std::filesystem::read_symlink("/proc/self/exe", error);
  const char* path = std::getenv("PATH");
  if (!error) setenv("PATH", (own.parent_path().string() + ":" + (path ? path : "/usr/bin:/bin")).c_str(), 1);
  setenv("CURBSTONE_CONFIG", "/etc/curbstone/ugv.yaml", 0);
}

}  // namespace curbstone::procman::deputy
