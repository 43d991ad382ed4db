#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace curbstone::simulate::rig {

/// An emulated device at the far end of a serial line. Pure: bytes and times in, bytes out. Times are utime, us since
/// the Unix epoch.
class SerialDevice {
 public:
  using Bytes = std::vector<std::uint8_t>;

  virtual ~SerialDevice() = default;
  /// Switches the supply on.
  virtual Bytes power_on(std::int64_t now) = 0;
  /// Takes bytes from the host; returns the responses.
  virtual Bytes on_bytes(std::int64_t now, std::span<const std::uint8_t> bytes) = 0;
  /// When the device next sends unsolicited data; run() is to be called then.
  [[nodiscard]] virtual std::int64_t next_due() const = 0;
  /// The data it sends at `now`, with the vehicle `t` seconds into its drive. Times must not decrease.
  virtual Bytes run(std::int64_t now, double t) = 0;
};

}  // namespace curbstone::simulate::rig
