#pragma once

#include <cstdint>
#include <curbstone/service_status_t.hpp>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>

namespace curbstone::spy::board {

/// A service as its last SERVICE_STATUS says, and how much changed since the one before.
struct ServiceState {
  service_status_t status;
  std::int64_t heard = 0;  ///< us, when it came
  /// Of the time between two statuses; NaN before the second.
  double cpu = std::numeric_limits<double>::quiet_NaN();      ///< cores
  double dropped = std::numeric_limits<double>::quiet_NaN();  ///< messages/s: dropped.* and lost.*
  double refused = std::numeric_limits<double>::quiet_NaN();  ///< messages/s: refused.*
  /// us, the status's stamp minus its arrival: the clock of its host minus ours, less the way here.
  std::int64_t clock = 0;

  [[nodiscard]] bool is_silent(std::int64_t now) const { return now - heard > kSilence; }
  [[nodiscard]] std::optional<std::int64_t> counter(const std::string& name) const;

  static constexpr std::int64_t kSilence = 3'000'000;  ///< us; it speaks each second
};

/// All services that were heard, by name and host. Pure; times of arrival in us since the Unix epoch.
class ServiceBoard {
 public:
  static constexpr std::size_t kMost = 200;  ///< services; the bus may be full of garbage

  void add(const service_status_t& status, std::int64_t now);
  [[nodiscard]] const std::map<std::pair<std::string, std::string>, ServiceState>& services() const {
    return services_;
  }

 private:
  std::map<std::pair<std::string, std::string>, ServiceState> services_;
};

}  // namespace curbstone::spy::board
