#pragma once

#include <cstdint>
#include <curbstone/imu_t.hpp>
#include <curbstone/wheels_t.hpp>

#include "services/ekf/base/samples.hpp"

namespace curbstone::ekf {

/// A simulated sample as its driver would send it.
inline imu_t message_of(const base::ImuSample& sample, std::int32_t sequence) {
  imu_t m{};
  m.utime = sample.utime;
  m.sequence = sequence;
  for (int i = 0; i < 3; ++i) {
    m.angular_rate[i] = sample.angular_rate[i];
    m.acceleration[i] = sample.acceleration[i];
  }
  return m;
}

inline wheels_t message_of(const base::WheelSample& sample, std::int32_t sequence) {
  wheels_t m{};
  m.utime = sample.utime;
  m.sequence = sequence;
  m.angle[0] = sample.angle[0];
  m.angle[1] = sample.angle[1];
  m.enabled = true;
  return m;
}

}  // namespace curbstone::ekf
