#include "tools/bench/faults/small_disk.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sched.h>
#include <sys/mount.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>
#include <vector>

namespace curbstone::bench::faults {

SmallDisk::SmallDisk(std::string folder, int megabytes) : folder_(std::move(folder)) {
  const std::string size = fmt::format("size={}m", megabytes);
  // In its own mount namespace: other processes do not see it, and it is removed with the last process in the
  // namespace.
  if (unshare(CLONE_NEWNS) != 0 || mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
      mount("tmpfs", folder_.c_str(), "tmpfs", 0, size.c_str()) != 0)
    throw std::runtime_error(fmt::format("{}: no small disk can be made: {}", folder_, std::strerror(errno)));
}

SmallDisk::~SmallDisk() {
  umount2(folder_.c_str(), MNT_DETACH);
}

void SmallDisk::fill() const {
  const int file = open(ballast().c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (file < 0) throw std::runtime_error(fmt::format("{}: {}", ballast(), std::strerror(errno)));
  for (std::size_t size = 1 << 20; size > 0; size /= 2) {
    const std::vector<char> zeros(size);
    while (write(file, zeros.data(), size) == static_cast<ssize_t>(size)) continue;
  }
  close(file);
}

void SmallDisk::free() const {
  unlink(ballast().c_str());
}

}  // namespace curbstone::bench::faults
