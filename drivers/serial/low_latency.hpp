#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace curbstone::serial {

/// What a port's driver grants of low latency. An FTDI chip holds bytes back until 62 are there or its latency timer
/// runs out, 16 ms by default; other drivers may wait for a work queue.
struct LowLatency {
  bool granted = false;         ///< ASYNC_LOW_LATENCY is set (TIOCSSERIAL); for FTDI that sets the timer to 1 ms too
  std::optional<int> timer_ms;  ///< of an FTDI chip, as its driver tells it; empty for others

  bool operator==(const LowLatency&) const = default;
};

/// Asks the driver of the open port `fd`, opened under the name `device`, and writes 1 ms into its latency timer in
/// sysfs. What is refused (a pseudo-terminal, a CDC device, no permission) is no error. `sys`: where sysfs is.
LowLatency request_low_latency(int fd, const std::string& device, const std::filesystem::path& sys = "/sys");

}  // namespace curbstone::serial
