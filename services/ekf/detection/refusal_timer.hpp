#pragma once

#include <cstdint>
#include <optional>

#include "services/ekf/base/samples.hpp"

namespace curbstone::ekf::detection {

/// Measures how long a sensor has been refused without a break. A sensor that disagrees for seconds on end is more
/// likely right than a filter that integrates alone.
class RefusalTimer {
 public:
  /// Returns true once when the refusals have lasted for `patience` s, then restarts.
  [[nodiscard]] bool expired(bool refused, std::int64_t utime, double patience) {
    if (!refused) {
      since_.reset();
      return false;
    }
    if (!since_) since_ = utime;
    if (base::seconds_between(*since_, utime) < patience) return false;
    since_.reset();
    return true;
  }
  void reset() { since_.reset(); }

 private:
  std::optional<std::int64_t> since_;  // us
};

}  // namespace curbstone::ekf::detection
