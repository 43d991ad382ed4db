#include "tools/simulate/rig/fault_plan.hpp"

#include <cstdio>

namespace curbstone::simulate::rig {

std::optional<SensorFault> parse_fault(const std::string& text) {
  char sensor[8] = {}, kind[8] = {};
  SensorFault fault;
  int used = 0;
  if (std::sscanf(text.c_str(), "%7[a-z]-%7[a-z]:%lf-%lf%n", sensor, kind, &fault.from, &fault.to, &used) != 4 ||
      static_cast<std::size_t>(used) != text.size() || !(fault.from >= 0) || !(fault.to > fault.from))
    return std::nullopt;
  const std::string who = sensor, what = kind;
  if (who == "lidar") {
    fault.sensor = SensorFault::Sensor::kLidar;
  } else if (who == "imu") {
    fault.sensor = SensorFault::Sensor::kImu;
  } else if (who == "wheels") {
    fault.sensor = SensorFault::Sensor::kWheels;
  } else {
    return std::nullopt;
  }
  if (what != "silent" && what != "garbage") return std::nullopt;
  fault.kind = what == "silent" ? SensorFault::Kind::kSilent : SensorFault::Kind::kGarbage;
  return fault;
}

}  // namespace curbstone::simulate::rig
