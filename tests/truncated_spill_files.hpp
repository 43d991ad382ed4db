#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <filesystem>
#include <string>

namespace curbstone::test {

/// What this process has spilled is lost, as on a disk that fails.
inline void truncate_spill_files() {
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code gone;
    const std::string name = std::filesystem::read_symlink(entry.path(), gone).string();
    if (gone || name.find(".curbstone-spill-") == std::string::npos) continue;
    const int file = ::open(entry.path().c_str(), O_WRONLY | O_CLOEXEC);
    if (file < 0) continue;
    (void)!::ftruncate(file, 0);
    ::close(file);
  }
}

}  // namespace curbstone::test
