#include "drivers/serial/low_latency.hpp"

#include <linux/serial.h>
#include <sys/ioctl.h>

#include <fstream>
#include <system_error>

namespace curbstone::serial {

namespace {

constexpr int kMinLatency = 1;  // ms

bool set_flag(int fd) {
  serial_struct port{};
  if (::ioctl(fd, TIOCGSERIAL, &port) != 0) return false;
  port.flags = static_cast<int>(static_cast<unsigned>(port.flags) | ASYNC_LOW_LATENCY);
  if (::ioctl(fd, TIOCSSERIAL, &port) != 0) return false;
  return ::ioctl(fd, TIOCGSERIAL, &port) == 0 && (static_cast<unsigned>(port.flags) & ASYNC_LOW_LATENCY) != 0;
}

std::optional<int> read_timer(const std::filesystem::path& file) {
  int ms = 0;
  if (std::ifstream in(file); in >> ms) return ms;
  return {};
}

}  // namespace

LowLatency request_low_latency(int fd, const std::string& device, const std::filesystem::path& sys) {
  LowLatency result;
  result.granted = set_flag(fd);
  std::error_code error;
  const auto port = std::filesystem::canonical(device, error);  // the name may be a symbolic link of udev
  if (error) return result;
  const auto file = sys / "bus/usb-serial/devices" / port.filename() / "latency_timer";
  result.timer_ms = read_timer(file);
  if (result.timer_ms.value_or(kMinLatency) <= kMinLatency) return result;
  if (std::ofstream out(file); out) out << kMinLatency;
  result.timer_ms = read_timer(file);
  return result;
}

}  // namespace curbstone::serial
