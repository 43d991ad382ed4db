#include "tools/output/ordered_log.hpp"

#include <curbstone/imu_t.hpp>
#include <curbstone/lidar_points_t.hpp>
#include <curbstone/wheels_t.hpp>
#include <utility>

#include "common/bytes/big_endian.hpp"
#include "common/log/message_order.hpp"

namespace curbstone::output {

bool is_of_a_driver(const std::string& channel) {
  return channel == "LIDAR_POINTS" || channel == "IMU" || channel == "WHEELS";
}

bool has_other_type(const LogEvent& event) {
  const std::int64_t expected = event.channel == "LIDAR_POINTS" ? lidar_points_t::getHash()
                                : event.channel == "IMU"        ? imu_t::getHash()
                                                                : wheels_t::getHash();
  return event.bytes.size() < 8 || static_cast<std::int64_t>(read_big_endian<std::uint64_t>(event.bytes)) != expected;
}

void read_in_order(WatchedLog& log, const std::function<bool(const std::string& channel)>& wanted,
                   const std::function<void(const LogEvent&)>& take) {
  MessageOrder order;
  while (auto event = log.next()) {
    if (!wanted(event->channel)) continue;
    order.push(std::move(*event));
    while (const auto ready = order.pop()) take(*ready);
  }
  while (const auto ready = order.pop_rest()) take(*ready);
}

}  // namespace curbstone::output
