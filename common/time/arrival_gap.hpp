#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <optional>
#include <string>

namespace curbstone {

/// Stamp minus arrival time of a driver's samples, second by second: that of the least delayed sample of each second.
/// It is about zero, and at least minus the latency of the device and its line. Beyond kMaxDifference either the stamps
/// are of a clock other than the host's present one (the host's clock was set, and ClockOffset follows within seconds),
/// or no sample arrived punctually for a whole second. Pure; all times in us.
class ArrivalGap {
 public:
  static constexpr std::int64_t kMaxDifference = 50'000;  ///< us; more is a fault
  static constexpr std::int64_t kPeriod = 1'000'000;      ///< us, of arrivals

  void add(std::int64_t stamp, std::int64_t received) {
    if (std::abs(received - begun_) >= kPeriod) {
      difference_ = best_;
      best_.reset();
      begun_ = received;
    }
    best_ = std::max(best_.value_or(std::numeric_limits<std::int64_t>::min()), stamp - received);
  }

  /// The value of the last complete second with samples; nothing before the first one.
  [[nodiscard]] std::optional<std::int64_t> difference() const { return difference_; }
  /// A fault in words while the difference is too large.
  [[nodiscard]] std::optional<std::string> fault() const {
    if (!difference_ || std::abs(*difference_) <= kMaxDifference) return std::nullopt;
    return "stamps lie " + std::to_string(-*difference_ / 1000) +
           " ms before the arrivals: the host's clock was set, or this process waits for the CPU";
  }

 private:
  std::int64_t begun_ = 0;
  std::optional<std::int64_t> best_;  // of the present second
  std::optional<std::int64_t> difference_;
};

}  // namespace curbstone
