#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "drivers/lidar/sources/ipv4_address.hpp"

namespace curbstone::lidar::sources {

/// Chooses one device if none is configured: the first one that sends points of the model, until they have stayed away
/// for kSilence. So points and device information of two devices that send to the same ports are never mixed. Where two
/// devices share only the port of their information, the points decide: of that of a device without points nothing is
/// kept. Pure; times in us.
class OneSender {
 public:
  static constexpr std::int64_t kSilence = 1'000'000;

  enum class Kind {
    kForeign,  ///< of no device of the model: admitted from any sender, and refused later by its kind
    kInfo,
    kPoints,
  };

  /// Whether a packet may be used.
  [[nodiscard]] bool admits(Ipv4 sender, std::int64_t received, Kind kind) {
    if (kind == Kind::kForeign) return true;
    const bool silent = received - heard_ > kSilence || heard_ - received > kSilence;
    const bool points = kind == Kind::kPoints;
    if (!sender_ || (points ? !has_points_ || silent : !has_points_ && silent)) {
      is_another_ = is_another_ || (sender_ && *sender_ != sender);
      sender_ = sender;
    }
    if (*sender_ == sender) {
      if (points || !has_points_) heard_ = received;
      has_points_ = has_points_ || points;
      return true;
    }
    other_ = sender;
    other_heard_ = received;
    ++foreign_;
    return false;
  }
  /// Whether the latest packet that is admitted is of another device than those before: once.
  [[nodiscard]] bool is_another() { return std::exchange(is_another_, false); }
  [[nodiscard]] std::int64_t foreign() const { return foreign_; }
  /// The fault in words while a second device sends too, else empty. `now` on the clock of `received`.
  [[nodiscard]] std::string fault(std::int64_t now) const {
    if (!other_ || other_ == sender_ || now - other_heard_ > kSilence || other_heard_ - now > kSilence) return "";
    return "two devices send: " + to_text(*sender_) + " is read, " + to_text(*other_) +
           " is not; give each a port of its own, or set device_address";
  }

 private:
  std::optional<Ipv4> sender_;
  bool has_points_ = false;  // it has sent points
  bool is_another_ = false;
  std::int64_t heard_ = 0;  // its points; before the first of them, its information
  std::optional<Ipv4> other_;
  std::int64_t other_heard_ = 0;
  std::int64_t foreign_ = 0;
};

}  // namespace curbstone::lidar::sources
