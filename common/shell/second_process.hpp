#pragma once

#include <cstdint>
#include <curbstone/service_config_t.hpp>
#include <optional>
#include <string>

namespace curbstone {

/// Detects a second process of the same section under another name, for example that of another vehicle on the same
/// network. Both send on the same channels, where no listener can tell them apart. Pure.
class SecondProcess {
 public:
  static constexpr std::int64_t kRecent = 12'000'000;       ///< us: a process sends its CONFIG each 5 s
  static constexpr std::int64_t kClocksDiffer = 3'000'000;  ///< us, between two hosts; a log differs by more

  /// Takes any CONFIG on the bus. `own`: that of this process. `now`: us on the host's clock.
  void on_config(const service_config_t& message, const service_config_t& own, std::int64_t now) {
    if (message.section != own.section || message.service == own.service) return;
    if (message.utime > now + kClocksDiffer || now - message.utime > kClocksDiffer) return;
    const std::string who = message.service + " on " + message.host;
    heard_ = who == who_ ? heard_ + 1 : 1;  // a single one may be the last of a predecessor
    who_ = who;
    last_ = now;
  }
  [[nodiscard]] std::optional<std::string> fault(const std::string& section, std::int64_t now) const {
    if (heard_ < 2 || now < last_ || now - last_ > kRecent) return std::nullopt;
    return "two of " + section + " are on this bus, and their messages mix: end " + who_ + ", or this one";
  }

 private:
  int heard_ = 0;  // in a row
  std::string who_;
  std::int64_t last_ = 0;  // us
};

}  // namespace curbstone
