#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace curbstone::simulate::rig {

/// An emulated device at the far end of a serial line. Pure: bytes and times go in, bytes come out. Times are utime, us
/// since the Unix epoch.
class SerialDevice {
 public:
  using Bytes = std::vector<std::uint8_t>;

  virtual ~SerialDevice() = default;
  /// The supply comes on.
  virtual Bytes power_on(std::int64_t now) = 0;
  /// What the host wrote; returns the answers.
  virtual Bytes on_bytes(std::int64_t now, std::span<const std::uint8_t> bytes) = 0;
  /// When the device has something to say of its own accord; run() is to be called then.
  [[nodiscard]] virtual std::int64_t next_due() const = 0;
  /// What it says at `now`, for a vehicle that is `t` seconds into its drive; times do not go back.
  virtual Bytes run(std::int64_t now, double t) = 0;
};

}  // namespace curbstone::simulate::rig
