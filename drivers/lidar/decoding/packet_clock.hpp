#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "common/time/clock_offset.hpp"

namespace curbstone::lidar::decoding {

/// The clock of the points' times.
enum class ClockMode {
  kAuto,    ///< the device's stamps while they agree with a synchronised host clock, else the host's clock
  kDevice,  ///< the device's stamps, set by its GPS or PTP
  kHost,    ///< the host's clock
};

/// Determines a packet's time: the device's own stamp, or the host's clock. A function of the packets and of whether
/// the host's clock is synchronised. All times in us since the Unix epoch.
class PacketClock {
 public:
  /// `tolerance`: for kAuto, which decides on the first packet. It changes its decision only after kPatience contrary
  /// packets in a row (1 s of an RS16).
  PacketClock(ClockMode mode, std::int64_t tolerance) : mode_(mode), tolerance_(tolerance) {}

  struct Time {
    std::int64_t utime = 0;       ///< of the first shot, to be published
    std::int64_t host_utime = 0;  ///< the same on the host's clock without jumps, for the estimation of losses
  };

  /// `stamp`: the device's time of the first shot; `received`: time of receipt; `duration`: from the first shot to the
  /// sending of the packet. `host_is_synchronised`: the host's clock is synchronised (NTP, PTP), so that it may judge
  /// the device's. `in_order`: the packet arrived in its turn; otherwise its time of receipt says nothing about the
  /// clocks' offset.
  Time time_of(std::optional<std::int64_t> stamp, std::int64_t received, std::int64_t duration,
               bool host_is_synchronised, bool in_order);

  /// The device's clock was set, or the device was replaced: its offset is determined anew, and the next packet decides
  /// on the clock, because the loss of GPS may leave the device in the year 2000.
  void restart() {
    decided_ = false;
    contrary_count_ = kRestarted;
    forget_offset();
  }

  /// The host's clock was set: only the offset is determined anew.
  void forget_offset() {
    offset_ = make_offset();
    stamped_ = false;
  }

  [[nodiscard]] bool uses_device() const { return uses_device_; }
  [[nodiscard]] std::int64_t switches() const { return switches_; }  ///< of the clock, after the first choice
  /// Device minus host, by the least delayed packet of the last seconds; nothing before the first stamp.
  [[nodiscard]] std::optional<std::int64_t> difference() const;
  /// How far the device's clock drifts against the host's; what is on the host's clock is corrected by it.
  [[nodiscard]] const ClockDrift& drift() const { return offset_.drift(); }

  static constexpr int kPatience = 750;

 private:
  /// Without detection of jumps, which PacketOrder does.
  static ClockOffset make_offset() { return ClockOffset(5'000'000, std::numeric_limits<std::int64_t>::max()); }
  void choose(bool device_is_sane);
  static constexpr int kRestarted = -1;

  ClockMode mode_;
  std::int64_t tolerance_;
  ClockOffset offset_ = make_offset();
  bool stamped_ = false;
  bool decided_ = false;
  bool uses_device_ = false;
  int contrary_count_ = 0;
  std::int64_t switches_ = 0;
};

}  // namespace curbstone::lidar::decoding
