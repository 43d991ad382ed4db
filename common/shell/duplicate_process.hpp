#pragma once

#include <cstdint>
#include <curbstone/service_status_t.hpp>
#include <optional>
#include <string>

namespace curbstone {

/// Detects a second process with the same name on the bus, for example one started by hand, or the same one on two
/// hosts. Their messages mix, and no listener can tell them apart. Pure.
class DuplicateProcess {
 public:
  static constexpr std::int64_t kRecent = 3'000'000;  ///< us: statuses come each second

  /// Takes any status on the bus. `now`: us on the host's clock. `own`: the status of this process. A status whose
  /// stamp is more than kRecent from `now`, as from a log, is ignored.
  void on_status(const service_status_t& message, const service_status_t& own, std::int64_t now) {
    if (message.service != own.service || (message.pid == own.pid && message.host == own.host)) return;
    if (message.utime > now + kRecent || now - message.utime > kRecent) return;
    const bool again = pid_ == message.pid && host_ == message.host;
    heard_ = again ? heard_ + 1 : 1;  // a single status may be the last one of a predecessor
    pid_ = message.pid;
    host_ = message.host;
    last_ = now;
  }
  [[nodiscard]] std::optional<std::string> fault(std::int64_t now) const {
    if (heard_ < 2 || now < last_ || now - last_ > kRecent) return std::nullopt;
    return "another process has this name: pid " + std::to_string(pid_) + " on " + host_;
  }

 private:
  int heard_ = 0;  // in a row
  std::int32_t pid_ = 0;
  std::string host_;
  std::int64_t last_ = 0;  // us
};

}  // namespace curbstone
