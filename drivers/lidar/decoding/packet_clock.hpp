#pragma once

#include <cstdint>
#include <optional>

#include "common/time/clock_offset.hpp"

namespace curbstone::lidar::decoding {

/// Whose time the points bear.
enum class ClockMode {
  kAuto,    ///< the device's stamps while they are within a tolerance of the host's clock, else the host's clock
  kDevice,  ///< the device's stamps, which its GPS has set
  kHost,    ///< the host's clock
};

/// Decides a packet's time: the device's own stamp (UTC from its GPS), or the host's clock. A function of the packets
/// alone. All times in us since the Unix epoch.
class PacketClock {
 public:
  /// `tolerance`: of kAuto, which decides on the first packet. It changes its mind only after kPatience packets in a
  /// row (1 s) that speak against it.
  PacketClock(ClockMode mode, std::int64_t tolerance) : mode_(mode), tolerance_(tolerance) {}

  struct Time {
    std::int64_t utime = 0;  ///< of the first shot, to be published
    std::int64_t even = 0;   ///< the same on the host's clock without jumps: for telling what was lost
  };

  /// `stamp`: of the first shot by the device; `received`: when the packet came, `duration`: from the first shot to
  /// when it was sent.
  Time time_of(std::optional<std::int64_t> stamp, std::int64_t received, std::int64_t duration);

  [[nodiscard]] bool uses_device() const { return uses_device_; }
  [[nodiscard]] std::int64_t switches() const { return switches_; }     ///< between device and host, after the first
  [[nodiscard]] std::int64_t jumps() const { return offset_.jumps(); }  ///< of the device's clock
  [[nodiscard]] std::int64_t last_difference() const { return difference_; }  ///< device minus host

  static constexpr int kPatience = 750;

 private:
  void choose(bool device_is_sane);

  ClockMode mode_;
  std::int64_t tolerance_;
  ClockOffset offset_;
  std::int64_t difference_ = 0;
  bool decided_ = false;
  bool uses_device_ = false;
  int contrary_ = 0;
  std::int64_t switches_ = 0;
};

}  // namespace curbstone::lidar::decoding
