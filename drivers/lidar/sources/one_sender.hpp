#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "drivers/lidar/sources/ipv4_address.hpp"

namespace curbstone::lidar::sources {

/// Chooses one device if none is configured: the first one that sends packets of the model, until it has been silent
/// for kSilence. So points and device information of two devices that send to the same ports are never mixed. Pure;
/// times in us.
class OneSender {
 public:
  static constexpr std::int64_t kSilence = 1'000'000;

  /// Whether a packet may be used. `is_own`: it belongs to the model. Other packets are admitted from any sender, and
  /// refused later by their kind.
  [[nodiscard]] bool admits(Ipv4 sender, std::int64_t received, bool is_own) {
    if (!is_own) return true;
    const bool silent = !sender_ || received - heard_ > kSilence || heard_ - received > kSilence;
    if (silent) sender_ = sender;
    if (*sender_ == sender) {
      heard_ = received;
      return true;
    }
    other_ = sender;
    other_heard_ = received;
    ++foreign_;
    return false;
  }
  [[nodiscard]] std::int64_t foreign() const { return foreign_; }
  /// The fault in words while a second device sends too, else empty. `now` on the clock of `received`.
  [[nodiscard]] std::string fault(std::int64_t now) const {
    if (!other_ || other_ == sender_ || now - other_heard_ > kSilence || other_heard_ - now > kSilence) return "";
    return "two devices send: " + to_text(*sender_) + " is read, " + to_text(*other_) +
           " is not; give each a port of its own, or set device_address";
  }

 private:
  std::optional<Ipv4> sender_;
  std::int64_t heard_ = 0;
  std::optional<Ipv4> other_;
  std::int64_t other_heard_ = 0;
  std::int64_t foreign_ = 0;
};

}  // namespace curbstone::lidar::sources
