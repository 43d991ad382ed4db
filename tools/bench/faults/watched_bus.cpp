#include "tools/bench/faults/watched_bus.hpp"

#include <algorithm>
#include <chrono>

namespace curbstone::bench::faults {

WatchedBus::WatchedBus() {
  bus.subscribe<service_status_t>("SERVICE_STATUS", [this](const auto& message) {
    services[message.service] = message;
    auto& faults = all_faults[message.service];
    for (const std::string& fault : message.fault) {
      if (std::find(faults.begin(), faults.end(), fault) == faults.end() && faults.size() < 100)
        faults.push_back(fault);
    }
  });
  bus.subscribe<procman_lcm::deputy_info_t>("PM_INFO", [this](const auto& message) {
    deputy = message;
    ++infos;
  });
  bus.subscribe<procman_lcm::output_t>("PM_OUTPUT", [this](const auto& message) {
    for (std::size_t i = 0; i < message.text.size(); ++i) output[message.command_ids[i]] += message.text[i];
  });
}

bool WatchedBus::wait_until(const std::function<bool()>& condition, double seconds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!condition()) {
    if (std::chrono::steady_clock::now() >= end) return false;
    bus.handle(std::chrono::milliseconds(20));
  }
  return true;
}

const service_status_t* WatchedBus::status(const std::string& service) const {
  const auto it = services.find(service);
  return it == services.end() ? nullptr : &it->second;
}

std::int64_t WatchedBus::counter(const std::string& service, const std::string& name) const {
  const service_status_t* message = status(service);
  if (message == nullptr) return 0;
  for (std::size_t i = 0; i < message->counter_name.size(); ++i) {
    if (message->counter_name[i] == name) return message->counter_value[i];
  }
  return 0;
}

bool WatchedBus::has_fault(const std::string& service, const std::string& text) const {
  const service_status_t* message = status(service);
  return message != nullptr && std::any_of(message->fault.begin(), message->fault.end(), [&](const std::string& fault) {
           return fault.find(text) != std::string::npos;
         });
}

bool WatchedBus::is_healthy(const std::string& service) const {
  const service_status_t* message = status(service);
  return message != nullptr && message->fault.empty();
}

const procman_lcm::cmd_status_t* WatchedBus::command(const std::string& id) const {
  for (const auto& status : deputy.cmds) {
    if (status.cmd.command_id == id) return &status;
  }
  return nullptr;
}

int WatchedBus::pid(const std::string& id) const {
  const auto* status = command(id);
  return status == nullptr ? -1 : status->pid;
}

}  // namespace curbstone::bench::faults
