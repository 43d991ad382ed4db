#pragma once

#include <cstdint>
#include <curbstone/service_status_t.hpp>
#include <string>
#include <utility>
#include <vector>

namespace curbstone::spy {

template <class Message>
std::vector<std::uint8_t> encoded(const Message& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

inline service_status_t status_of(const std::string& service, std::int64_t uptime) {
  service_status_t status{};
  status.service = service;
  status.host = "ugv";
  status.pid = 7;
  status.uptime = uptime;
  return status;
}

inline void set_counters(service_status_t& status, const std::vector<std::pair<std::string, std::int64_t>>& counters) {
  status.counter_name.clear();
  status.counter_value.clear();
  for (const auto& [name, value] : counters) {
    status.counter_name.push_back(name);
    status.counter_value.push_back(value);
  }
  status.num_counters = static_cast<std::int32_t>(counters.size());
}

}  // namespace curbstone::spy
