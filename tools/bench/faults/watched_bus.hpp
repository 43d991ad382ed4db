#pragma once

#include <curbstone/service_status_t.hpp>
#include <functional>
#include <map>
#include <procman_lcm/deputy_info_t.hpp>
#include <procman_lcm/output_t.hpp>
#include <string>

#include "common/bus/lcm_bus.hpp"

namespace curbstone::bench::faults {

/// What the processes say about themselves, as an operator sees it.
class WatchedBus {
 public:
  WatchedBus();

  /// Listens until `condition` holds; false when it did not within `seconds`.
  bool wait_until(const std::function<bool()>& condition, double seconds);

  /// The last word of a service; null when it was never heard.
  [[nodiscard]] const service_status_t* status(const std::string& service) const;
  /// A counter of its last word; 0 when it was never heard.
  [[nodiscard]] std::int64_t counter(const std::string& service, const std::string& name) const;
  /// Some fault of its last word contains `text`.
  [[nodiscard]] bool has_fault(const std::string& service, const std::string& text = "") const;
  [[nodiscard]] bool is_healthy(const std::string& service) const;

  /// A command's pid as the deputy reports it: 0 not running, -1 not heard of.
  [[nodiscard]] int pid(const std::string& command) const;
  [[nodiscard]] const procman_lcm::cmd_status_t* command(const std::string& id) const;

  LcmBus bus;
  std::map<std::string, service_status_t> services;
  std::map<std::string, std::vector<std::string>> all_faults;  ///< ever heard, by service
  procman_lcm::deputy_info_t deputy;
  int infos = 0;
  std::map<std::string, std::string> output;  ///< PM_OUTPUT by command
};

}  // namespace curbstone::bench::faults
