#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace curbstone::serial {

/// Low latency as granted by a port's driver. An FTDI chip holds bytes back until it has 62 or its latency timer ends,
/// 16 ms by default; other drivers may wait for a work queue.
struct LowLatency {
  bool granted = false;         ///< ASYNC_LOW_LATENCY is set (TIOCSSERIAL); for FTDI that sets the timer to 1 ms too
  std::optional<int> timer_ms;  ///< of an FTDI chip, as reported by its driver; empty for others

  bool operator==(const LowLatency&) const = default;
};

/// Requests low latency for the open port `fd`, opened by the name `device`, and writes 1 ms to its latency timer in
/// sysfs. A refusal (a pseudo-terminal, a CDC device, no permission) is not an error. `sys`: path of sysfs.
LowLatency request_low_latency(int fd, const std::string& device, const std::filesystem::path& sys = "/sys");

}  // namespace curbstone::serial
