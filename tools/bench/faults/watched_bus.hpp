#pragma once

#include <curbstone/service_status_t.hpp>
#include <functional>
#include <map>
#include <procman_lcm/deputy_info_t.hpp>
#include <procman_lcm/output_t.hpp>
#include <string>

#include "common/bus/lcm_bus.hpp"

namespace curbstone::bench::faults {

/// The status of the processes on the bus, as an operator sees it.
class WatchedBus {
 public:
  WatchedBus();

  /// Listens until `condition` holds. False if it did not within `seconds`.
  bool wait_until(const std::function<bool()>& condition, double seconds);

  /// The last status of a service; null if there was none.
  [[nodiscard]] const service_status_t* status(const std::string& service) const;
  /// A counter of the last status; 0 if there was none.
  [[nodiscard]] std::int64_t counter(const std::string& service, const std::string& name) const;
  /// Whether a fault in the last status contains `text`.
  [[nodiscard]] bool has_fault(const std::string& service, const std::string& text = "") const;
  [[nodiscard]] bool is_healthy(const std::string& service) const;

  /// A command's pid as the deputy reports it: 0 not running, -1 not reported.
  [[nodiscard]] int pid(const std::string& command) const;
  [[nodiscard]] const procman_lcm::cmd_status_t* command(const std::string& id) const;

  LcmBus bus;
  std::map<std::string, service_status_t> services;
  std::map<std::string, std::vector<std::string>> all_faults;  ///< ever reported, by service
  procman_lcm::deputy_info_t deputy;
  int infos = 0;
  std::map<std::string, std::string> output;  ///< PM_OUTPUT by command
};

}  // namespace curbstone::bench::faults
