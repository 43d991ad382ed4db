#include "drivers/serial/line_settings.hpp"

// termios2 is the kernel's own structure; its header and <termios.h> exclude each other.
#include <asm/ioctls.h>
#include <asm/termbits.h>
#include <sys/ioctl.h>

#include <cerrno>

namespace curbstone::serial {

int set_raw_line(int fd, int baud) {
  termios2 line{};
  if (::ioctl(fd, TCGETS2, &line) != 0) return errno;
  line.c_iflag = 0;
  line.c_oflag = 0;
  line.c_lflag = 0;
  line.c_cflag &= ~static_cast<tcflag_t>(CSIZE | CSTOPB | PARENB | CRTSCTS | CBAUD | (CBAUD << IBSHIFT));
  line.c_cflag |= CS8 | CLOCAL | CREAD | BOTHER | (BOTHER << IBSHIFT);
  line.c_ispeed = line.c_ospeed = static_cast<speed_t>(baud);
  line.c_cc[VMIN] = 1;  // a read of 0 bytes then means that the device has vanished
  line.c_cc[VTIME] = 0;
  if (::ioctl(fd, TCSETS2, &line) != 0) return errno;
  ::ioctl(fd, TCFLSH, TCIOFLUSH);
  return 0;
}

int granted_baud(int fd) {
  termios2 line{};
  return ::ioctl(fd, TCGETS2, &line) == 0 ? static_cast<int>(line.c_ospeed) : 0;
}

}  // namespace curbstone::serial
