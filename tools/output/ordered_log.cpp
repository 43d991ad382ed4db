#include "tools/output/ordered_log.hpp"

#include <utility>

#include "common/log/message_order.hpp"

namespace curbstone::output {

bool is_of_a_driver(const std::string& channel) {
  return channel == "LIDAR_POINTS" || channel == "IMU" || channel == "WHEELS";
}

void read_in_order(WatchedLog& log, const std::function<bool(const std::string& channel)>& wanted,
                   const std::function<void(const LogEvent&)>& take) {
  MessageOrder order;
  while (auto event = log.next()) {
    if (!wanted(event->channel)) continue;
    order.push(std::move(*event));
    while (const auto ready = order.pop(false)) take(*ready);
  }
  while (const auto ready = order.pop(true)) take(*ready);
}

}  // namespace curbstone::output
