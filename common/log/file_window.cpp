#include "common/log/file_window.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace curbstone {

namespace {

constexpr std::size_t kReadAtOnce = 1 << 20;

}  // namespace

/// O_NONBLOCK: otherwise opening a named pipe would wait for a writer before the pipe can be refused.
FileWindow::FileWindow(const std::string& file) : fd_(open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
  const auto refuse = [&](const char* why) {
    if (fd_ >= 0) close(fd_);
    throw std::runtime_error(fmt::format("{}: cannot be read: {}", file, why));
  };
  struct stat status {};
  if (fd_ < 0 || fstat(fd_, &status) != 0) refuse(std::strerror(errno));
  if (S_ISDIR(status.st_mode)) refuse("it is a folder");
  if (!S_ISREG(status.st_mode)) refuse("it is not a file");
  size_ = status.st_size;
}

FileWindow::~FileWindow() {
  close(fd_);
}

std::span<const std::uint8_t> FileWindow::at(std::int64_t from, std::size_t count) {
  if (from < 0 || from >= size_) return {};
  count = std::min(count, static_cast<std::size_t>(size_ - from));
  if (from < begin_ || from + static_cast<std::int64_t>(count) > begin_ + static_cast<std::int64_t>(window_.size())) {
    window_.resize(std::max(count, kReadAtOnce));
    begin_ = from;
    std::size_t got = 0;
    while (got < count) {
      const ssize_t n = pread(fd_, window_.data() + got, window_.size() - got, from + static_cast<off_t>(got));
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) break;
      got += static_cast<std::size_t>(n);
    }
    window_.resize(got);
  }
  const auto offset = static_cast<std::size_t>(from - begin_);
  return std::span<const std::uint8_t>(window_).subspan(offset, std::min(count, window_.size() - offset));
}

std::int64_t FileWindow::find(std::span<const std::uint8_t> bytes, std::int64_t from) {
  while (from < size_) {
    const auto part = at(from, 65'536);
    const auto found = std::search(part.begin(), part.end(), bytes.begin(), bytes.end());
    if (found != part.end()) return from + (found - part.begin());
    // A match across the end of this part is found in the next part. An unreadable place is skipped.
    from += part.size() > bytes.size() ? static_cast<std::int64_t>(part.size() - bytes.size() + 1) : 4096;
  }
  return size_;
}

}  // namespace curbstone
