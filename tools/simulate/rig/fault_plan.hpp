#pragma once

#include <optional>
#include <string>
#include <vector>

namespace curbstone::simulate::rig {

/// Something that goes wrong with a sensor for a while: "imu-silent:10-12" is seconds 10 to 12 of the drive.
struct SensorFault {
  enum class Sensor { kLidar, kImu, kWheels };
  enum class Kind { kSilent, kGarbage };
  Sensor sensor = Sensor::kImu;
  Kind kind = Kind::kSilent;
  double from = 0;
  double to = 0;
};

/// Nothing if the text is no fault.
[[nodiscard]] std::optional<SensorFault> parse_fault(const std::string& text);

class FaultPlan {
 public:
  void add(const SensorFault& fault) { faults_.push_back(fault); }
  /// What is wrong with the sensor at t, if anything.
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
