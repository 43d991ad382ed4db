#include "drivers/serial/serial_port.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace curbstone::serial {

namespace {

speed_t speed(int baud) {
  switch (baud) {
    case 9600:
      return B9600;
    case 19200:
      return B19200;
    case 38400:
      return B38400;
    case 57600:
      return B57600;
    case 115200:
      return B115200;
    case 230400:
      return B230400;
    case 460800:
      return B460800;
    case 500000:
      return B500000;
    case 921600:
      return B921600;
    case 1000000:
      return B1000000;
    case 2000000:
      return B2000000;
    default:
      throw std::runtime_error(fmt::format("baud {} is none: use 115200, 230400, 460800 or 921600", baud));
  }
}

/// What to do about it, where that is known.
std::string hint(int error) {
  switch (error) {
    case ENOENT:
      return ": is the device plugged in, and this its name? `ls -l /dev/serial/by-id /dev/tty*` shows what there is";
    case EACCES:
      return ": add the user to the group `dialout`, or run as root";
    case EBUSY:
      return ": another program holds it";
    default:
      return "";
  }
}

[[noreturn]] void fail(const std::string& device, int error) {
  throw std::runtime_error(fmt::format("cannot open serial port {}: {}{}", device, std::strerror(error), hint(error)));
}

/// Raw bytes, 8N1, whatever the last program left behind.
int configure(int fd, speed_t baud) {
  termios settings{};
  if (tcgetattr(fd, &settings) != 0) return errno;
  cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | CRTSCTS);
  settings.c_cc[VMIN] = 1;  // so that a read of 0 bytes means that the device is gone
  settings.c_cc[VTIME] = 0;
  cfsetispeed(&settings, baud);
  cfsetospeed(&settings, baud);
  if (tcsetattr(fd, TCSANOW, &settings) != 0) return errno;
  tcflush(fd, TCIOFLUSH);
  return 0;
}

}  // namespace

SerialPort::SerialPort(const SerialSettings& settings) {
  const speed_t baud = speed(settings.baud);
  fd_ = ::open(settings.device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (fd_ < 0) fail(settings.device, errno);
  // The lock is for everybody (root too), TIOCEXCL for programs that do not ask for the lock.
  int error = ::flock(fd_, LOCK_EX | LOCK_NB) != 0 ? (errno == EWOULDBLOCK ? EBUSY : errno) : 0;
  if (error == 0) error = configure(fd_, baud);
  if (error == 0) {
    ::ioctl(fd_, TIOCEXCL);
    return;
  }
  close();
  if (error == ENOTTY || error == EINVAL) {
    throw std::runtime_error(fmt::format("{} is no serial port", settings.device));
  }
  fail(settings.device, error);
}

SerialPort::~SerialPort() {
  close();
}

SerialPort::SerialPort(SerialPort&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}

SerialPort& SerialPort::operator=(SerialPort&& other) noexcept {
  if (this != &other) {
    close();
    fd_ = std::exchange(other.fd_, -1);
  }
  return *this;
}

void SerialPort::close() noexcept {
  if (fd_ < 0) return;
  ::ioctl(fd_, TIOCNXCL);
  ::close(fd_);
  fd_ = -1;
}

SerialPort::Read SerialPort::read(std::span<std::uint8_t> buffer) {
  const ssize_t size = ::read(fd_, buffer.data(), buffer.size());
  if (size > 0) return {Status::kData, static_cast<std::size_t>(size)};
  const bool nothing = size < 0 && (errno == EAGAIN || errno == EINTR);
  return {nothing ? Status::kNothing : Status::kGone, 0};
}

std::size_t SerialPort::write(std::span<const std::uint8_t> bytes) {
  const ssize_t size = ::write(fd_, bytes.data(), bytes.size());
  return size > 0 ? static_cast<std::size_t>(size) : 0;
}

}  // namespace curbstone::serial
