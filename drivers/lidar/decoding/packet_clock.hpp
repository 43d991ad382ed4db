#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "common/time/clock_offset.hpp"

namespace curbstone::lidar::decoding {

/// Whose time the points bear.
enum class ClockMode {
  kAuto,    ///< the device's stamps while they agree with the host's clock and that is synchronised, else the host's
  kDevice,  ///< the device's stamps, which its GPS or PTP has set
  kHost,    ///< the host's clock
};

/// Decides a packet's time: the device's own stamp, or the host's clock. A function of the packets and of whether the
/// host's clock is synchronised. All times in us since the Unix epoch.
class PacketClock {
 public:
  /// `tolerance`: of kAuto, which decides on the first packet. It changes its mind only after kPatience packets in a
  /// row (1 s of an RS16) that speak against it.
  PacketClock(ClockMode mode, std::int64_t tolerance) : mode_(mode), tolerance_(tolerance) {}

  struct Time {
    std::int64_t utime = 0;  ///< of the first shot, to be published
    std::int64_t even = 0;   ///< the same on the host's clock without jumps: for telling what was lost
  };

  /// `stamp`: of the first shot by the device; `received`: when the packet came, `duration`: from the first shot to
  /// when it was sent. `host_is_right`: somebody (NTP, PTP) keeps the host's clock, so that it may judge the device's.
  /// `in_order`: the packet came when its turn was; else its time of receipt tells nothing of the clocks' offset.
  Time time_of(std::optional<std::int64_t> stamp, std::int64_t received, std::int64_t duration, bool host_is_right,
               bool in_order);

  /// The device's clock was set, or the device is another one: its offset is to be found anew, and the next packet
  /// decides whose time is used, for a GPS that was lost may leave the device in the year 2000.
  void restart() {
    decided_ = false;
    contrary_ = kRestarted;
    forget_offset();
  }

  /// The host's clock was set: only the offset is to be found anew.
  void forget_offset() {
    offset_ = make_offset();
    stamped_ = false;
  }

  [[nodiscard]] bool uses_device() const { return uses_device_; }
  [[nodiscard]] std::int64_t switches() const { return switches_; }  ///< between device and host, after the first
  /// Device minus host, by the least delayed packet of the last seconds; nothing before the first stamp.
  [[nodiscard]] std::optional<std::int64_t> difference() const;

  static constexpr int kPatience = 750;

 private:
  /// Jumps are found by PacketOrder.
  static ClockOffset make_offset() { return ClockOffset(5'000'000, std::numeric_limits<std::int64_t>::max()); }
  void choose(bool device_is_sane);
  static constexpr int kRestarted = -1;

  ClockMode mode_;
  std::int64_t tolerance_;
  ClockOffset offset_ = make_offset();
  bool stamped_ = false;
  bool decided_ = false;
  bool uses_device_ = false;
  int contrary_ = 0;
  std::int64_t switches_ = 0;
};

}  // namespace curbstone::lidar::decoding
