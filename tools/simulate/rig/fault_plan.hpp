#pragma once

#include <optional>
#include <string>
#include <vector>

namespace curbstone::simulate::rig {

/// A temporary fault of a sensor: "imu-silent:10-12" lasts from second 10 to 12 of the drive.
struct SensorFault {
  enum class Sensor { kLidar, kImu, kWheels };
  enum class Kind { kSilent, kGarbage };
  Sensor sensor = Sensor::kImu;
  Kind kind = Kind::kSilent;
  double from = 0;
  double to = 0;
};

/// Empty if the text is not a fault.
[[nodiscard]] std::optional<SensorFault> parse_fault(const std::string& text);

class FaultPlan {
 public:
  void add(const SensorFault& fault) { faults_.push_back(fault); }
  /// The fault of the sensor at t, if any.
  [[nodiscard]] std::optional<SensorFault::Kind> at(SensorFault::Sensor sensor, double t) const {
    for (const auto& fault : faults_) {
      if (fault.sensor == sensor && t >= fault.from && t < fault.to) return fault.kind;
    }
    return std::nullopt;
  }

 private:
  std::vector<SensorFault> faults_;
};

}  // namespace curbstone::simulate::rig
