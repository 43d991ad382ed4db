#pragma once

#include <cstdint>
#include <curbstone/service_status_t.hpp>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>

namespace curbstone::spy::board {

/// The last SERVICE_STATUS of a service, and the changes since the one before.
struct ServiceState {
  service_status_t status;
  std::int64_t heard = 0;  ///< us, time of reception
  /// Rates between the last two statuses; NaN before the second one.
  double cpu = std::numeric_limits<double>::quiet_NaN();      ///< cores
  double dropped = std::numeric_limits<double>::quiet_NaN();  ///< messages/s: dropped.* and lost.*
  double refused = std::numeric_limits<double>::quiet_NaN();  ///< messages/s: refused.*
  /// us, the status's stamp minus its time of reception: the clock of its host minus ours, less the transit time.
  std::int64_t clock = 0;

  [[nodiscard]] bool is_silent(std::int64_t now) const { return now - heard > kSilence; }
  [[nodiscard]] std::optional<std::int64_t> counter(const std::string& name) const;

  static constexpr std::int64_t kSilence = 3'000'000;  ///< us; a status comes each second
};

/// All services received, by name and host. Pure; times of reception in us since the Unix epoch.
class ServiceBoard {
 public:
  static constexpr std::size_t kMaxServices = 200;  ///< services; the bus may carry garbage

  void add(const service_status_t& status, std::int64_t now);
  [[nodiscard]] const std::map<std::pair<std::string, std::string>, ServiceState>& services() const {
    return services_;
  }

 private:
  std::map<std::pair<std::string, std::string>, ServiceState> services_;
};

}  // namespace curbstone::spy::board
