#include "tests/services/ekf/wheel_fault.hpp"

#include <cmath>

namespace curbstone::ekf {

const std::vector<WheelFault>& tried_wheel_faults() {
  static const std::vector<WheelFault> faults = {
      {"left frozen", {0, 1}},
      {"right frozen", {1, 0}},
      {"both frozen", {0, 0}},
      {"left wrong sign", {-1, 1}},
      {"both wrong sign", {-1, -1}},
      {"swapped sign right", {1, -1}},
      {"left doubled", {2, 1}},
      {"right halved", {1, 0.5}},
      {"both doubled", {2, 2}},
      {"both halved", {0.5, 0.5}},
      {"left 10 % fast", {1.1, 1}},
      {"both 10 % fast", {1.1, 1.1}},
      {"left leaps 0.5 rad a second", {1, 1}, 0.5, 1.0},
  };
  return faults;
}

Drive with_fault(Drive drive, const WheelFault& fault, double onset) {
  if (drive.wheels.empty()) return drive;
  const std::int64_t begin = drive.wheels.front().utime;
  std::array<double, 2> at_onset{};
  for (base::WheelSample& sample : drive.wheels) {
    const double since = base::seconds_between(begin, sample.utime) - onset;
    if (since < 0) {
      at_onset = sample.angle;
      continue;
    }
    for (std::size_t i = 0; i < 2; ++i) sample.angle[i] = at_onset[i] + fault.gain[i] * (sample.angle[i] - at_onset[i]);
    sample.angle[0] += fault.step * std::floor(since / fault.every);
  }
  return drive;
}

}  // namespace curbstone::ekf
