#include "drivers/serial/serial_port.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "drivers/serial/line_settings.hpp"

namespace curbstone::serial {

namespace {

/// Advice for the error, if there is any.
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

}  // namespace

SerialPort::SerialPort(const SerialSettings& settings) {
  fd_ = ::open(settings.device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (fd_ < 0) fail(settings.device, errno);
  // The lock is for all programs (root too), TIOCEXCL for programs that do not use the lock.
  int error = ::flock(fd_, LOCK_EX | LOCK_NB) != 0 ? (errno == EWOULDBLOCK ? EBUSY : errno) : 0;
  if (error == 0) error = set_raw_line(fd_, settings.baud);
  if (error == 0) {
    ::ioctl(fd_, TIOCEXCL);
    baud_ = granted_baud(fd_);
    if (settings.low_latency) low_latency_ = request_low_latency(fd_, settings.device);
    return;
  }
  close();
  if (error == ENOTTY || error == EINVAL) {
    throw NotASerialPort(fmt::format("{} is no serial port", settings.device));
  }
  fail(settings.device, error);
}

SerialPort::~SerialPort() {
  close();
}

SerialPort::SerialPort(SerialPort&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)), baud_(other.baud_), low_latency_(other.low_latency_) {}

SerialPort& SerialPort::operator=(SerialPort&& other) noexcept {
  if (this != &other) {
    close();
    fd_ = std::exchange(other.fd_, -1);
    baud_ = other.baud_;
    low_latency_ = other.low_latency_;
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
