#pragma once

#include <cmath>
#include <cstdint>
#include <curbstone/imu_t.hpp>
#include <curbstone/lidar_points_t.hpp>
#include <curbstone/wheels_t.hpp>

namespace curbstone::fuzz {

/// What sensors that work say of a vehicle within a round wall. Without stamps, but for the points' own.

inline constexpr int kPacketsPerTurn = 24;

[[nodiscard]] inline imu_t imu_at_rest(int sequence) {
  imu_t m{};
  m.sequence = sequence;
  m.acceleration[2] = 9.81;
  m.temperature = 25;
  return m;
}

[[nodiscard]] inline wheels_t wheels_at(int sequence) {
  wheels_t m{};
  m.sequence = sequence;
  for (int side = 0; side < 2; ++side) {
    m.counts[side] = 100 * sequence;
    m.angle[side] = 0.1 * sequence;
    m.speed[side] = 5;
  }
  m.enabled = true;
  return m;
}

/// 24 points of one packet.
[[nodiscard]] inline lidar_points_t points_of(int packet) {
  lidar_points_t m{};
  m.packet = packet;
  m.revolution = packet / kPacketsPerTurn;
  m.num_points = 24;
  for (int i = 0; i < m.num_points; ++i) {
    const double azimuth = 2 * M_PI * (packet % kPacketsPerTurn + i / 24.0) / kPacketsPerTurn;
    m.x.push_back(static_cast<float>(8 * std::cos(azimuth)));
    m.y.push_back(static_cast<float>(-8 * std::sin(azimuth)));
    m.z.push_back(-1.7F + 0.3F * static_cast<float>(i % 8));
    m.time_offset.push_back(static_cast<float>(i) * 5e-5F);
    m.intensity.push_back(static_cast<std::uint8_t>(20 + i));
    m.ring.push_back(static_cast<std::uint8_t>(i % 16));
  }
  return m;
}

}  // namespace curbstone::fuzz
