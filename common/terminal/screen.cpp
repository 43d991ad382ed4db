#include "common/terminal/screen.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string_view>

namespace curbstone {

namespace {

winsize size_of_terminal(int fd) {
  winsize size{};
  if (ioctl(fd, TIOCGWINSZ, &size) != 0) size = {};
  return size;
}

bool wants_colours() {
  const char* const term = std::getenv("TERM");
  const char* const none = std::getenv("NO_COLOR");
  return term != nullptr && std::string_view(term) != "dumb" && (none == nullptr || *none == '\0');
}

bool write_whole(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write(fd, bytes.data(), bytes.size());
    if (written < 0 && (errno == EPIPE || errno == EIO)) return false;  // EIO: the terminal was closed
    if (written < 0 && errno != EINTR)
      throw std::runtime_error(fmt::format("standard output: cannot be written: {}", std::strerror(errno)));
    if (written > 0) bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

}  // namespace

Screen::Screen(int fd) : fd_(fd), is_terminal_(isatty(fd) == 1), colours_(is_terminal_ && wants_colours()) {}

TextStyle Screen::style() const {
  return is_terminal_ ? TextStyle{colours_, size_of_terminal(fd_).ws_col} : TextStyle{};
}

bool Screen::show(const std::vector<std::string>& lines) const {
  if (is_terminal_) return write_whole(fd_, screen_bytes(lines, size_of_terminal(fd_).ws_row));
  std::string text;
  for (const std::string& line : lines) text.append(line).append("\n");
  return write_whole(fd_, text);
}

std::string screen_bytes(const std::vector<std::string>& lines, std::size_t height) {
  std::string bytes = "\x1b[H";
  const std::size_t shown = height > 0 ? std::min(lines.size(), height) : lines.size();
  for (std::size_t k = 0; k < shown; ++k) {
    // No line end after the last line that fits: it would scroll.
    bytes.append(lines[k]).append("\x1b[K").append(k + 1 < shown ? "\r\n" : "");
  }
  return bytes.append("\x1b[J");
}

}  // namespace curbstone
