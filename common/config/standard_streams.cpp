#include "common/config/standard_streams.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <initializer_list>

namespace curbstone {

namespace {

/// The next file or socket would take the number of a stream that is closed (`nohup ... >&-`), and what is printed
/// would be written into it.
void open_closed_streams() {
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(fd, F_GETFD) < 0) (void)!::open("/dev/null", O_RDWR);  // takes the lowest number that is free
  }
}

bool reader_has_gone() {
  pollfd out{STDOUT_FILENO, POLLOUT, 0};
  return ::poll(&out, 1, 0) == 1 && (out.revents & POLLERR) != 0;
}

/// The C library flushes stdout after this, and ignores an error.
void check_what_was_printed() {
  const bool was_lost = std::ferror(stdout) != 0;
  errno = 0;
  const bool is_lost = std::fflush(stdout) != 0;
  const int error = errno;
  if ((!was_lost && !is_lost) || reader_has_gone()) return;
  // Of a failure that another flush has met the cause is not known any more.
  std::fprintf(stderr, "standard output: cannot be written: %s\n",
               error != 0 ? std::strerror(error) : "is the disk full?");
  ::_exit(1);
}

}  // namespace

void guard_standard_streams() {
  open_closed_streams();
  [[maybe_unused]] static const int once = std::atexit(check_what_was_printed);
}

}  // namespace curbstone
