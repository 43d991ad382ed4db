#include "services/viewer/store/services.hpp"

#include <algorithm>
#include <utility>

namespace curbstone::viewer::store {
namespace {

std::string shortened(const std::string& text) {
  return text.substr(0, Services::kMaxText);
}

bool is_loss(const std::string& counter) {
  return counter.starts_with("dropped.") || counter.starts_with("refused.") || counter.starts_with("lost.") ||
         counter.starts_with("faults.");
}

/// Whether `now` follows `before` in the same run of the process.
bool goes_on(const Services::Service& before, const service_status_t& now) {
  return before.pid == now.pid && before.uptime < now.uptime;
}

}  // namespace

bool Services::put(const service_status_t& message, std::int64_t now) {
  const std::string name = shortened(message.service);
  const auto known = services_.find(name);
  if (known == services_.end() && services_.size() >= kMaxServices) return false;

  Service service{.name = name,
                  .host = shortened(message.host),
                  .version = shortened(message.version),
                  .pid = message.pid,
                  .heard = now,
                  .uptime = message.uptime,
                  .cpu_time = message.cpu_time,
                  .memory = message.memory,
                  .latency_p50 = message.latency_p50,
                  .latency_p99 = message.latency_p99};
  const Service* before = known != services_.end() && goes_on(known->second, message) ? &known->second : nullptr;
  const double seconds = before == nullptr ? 0 : static_cast<double>(message.uptime - before->uptime) * 1e-6;
  if (before != nullptr) service.cpu = static_cast<double>(message.cpu_time - before->cpu_time) * 1e-6 / seconds;

  for (std::size_t i = 0; i < message.fault.size() && i < kMaxFaults; ++i)
    service.faults.push_back(shortened(message.fault[i]));
  const std::size_t counters = std::min(message.counter_name.size(), message.counter_value.size());
  for (std::size_t i = 0; i < counters && service.losses.size() < kMaxCounters; ++i) {
    if (!is_loss(message.counter_name[i])) continue;
    Loss loss{.name = shortened(message.counter_name[i]), .count = message.counter_value[i]};
    if (before != nullptr) {
      const auto last = std::find_if(before->losses.begin(), before->losses.end(),
                                     [&](const Loss& other) { return other.name == loss.name; });
      const std::int64_t more = loss.count - (last == before->losses.end() ? 0 : last->count);
      loss.rate = static_cast<double>(more) / seconds;
    }
    service.losses.push_back(std::move(loss));
  }
  services_[name] = std::move(service);
  return true;
}

}  // namespace curbstone::viewer::store
