#pragma once

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <string>

namespace curbstone::test {

/// do_to(descriptor), of each file that this process has spilled into.
inline void for_each_spill_file(const std::function<void(int)>& do_to) {
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code gone;
    const std::string name = std::filesystem::read_symlink(entry.path(), gone).string();
    if (gone || name.find(".curbstone-spill-") == std::string::npos) continue;
    const int file = ::open(entry.path().c_str(), O_RDWR | O_CLOEXEC);
    if (file < 0) continue;
    do_to(file);
    ::close(file);
  }
}

/// What this process has spilled is lost, as on a disk that fails.
inline void truncate_spill_files() {
  for_each_spill_file([](int file) { (void)!::ftruncate(file, 0); });
}

/// No file of this process can be written or read any more, as on a disk that was pulled out.
inline void make_spill_files_fail() {
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code gone;
    const std::string name = std::filesystem::read_symlink(entry.path(), gone).string();
    if (gone || name.find(".curbstone-spill-") == std::string::npos) continue;
    const int none = ::open("/", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    (void)!::dup2(none, std::stoi(entry.path().filename().string()));
    ::close(none);
  }
}

/// A bit of each page of it is another one, as on a disk that lies.
inline void flip_a_bit_of_each_spilled_page() {
  constexpr off_t kPage = 4096, kBit = 40;
  for_each_spill_file([](int file) {
    struct stat status {};
    (void)::fstat(file, &status);
    for (off_t at = kBit; at < status.st_size; at += kPage) {
      char byte = 0;
      if (::pread(file, &byte, 1, at) != 1) continue;
      byte = static_cast<char>(byte ^ 4);
      (void)!::pwrite(file, &byte, 1, at);
    }
  });
}

}  // namespace curbstone::test
