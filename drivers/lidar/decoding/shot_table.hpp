#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

namespace curbstone::lidar::decoding {

inline constexpr double kDegree = std::numbers::pi / 180.0;
inline constexpr std::size_t kRecordsPerBlock = 32;  ///< of all models

/// Direction of one laser of a device.
struct Laser {
  double elevation = 0;   ///< deg above the horizon
  double azimuth = 0;     ///< deg relative to the head's azimuth, clockwise
  double height = 0;      ///< m above the origin
  std::uint8_t ring = 0;  ///< rank by elevation, 0 = lowest
};

/// Times and directions of the shots of a data block, by record. Filled in when the device's angles become known. Each
/// quantity has an array of its own, so that several points of a block are computed at a time.
struct ShotTable {
  using Figures = std::array<double, kRecordsPerBlock>;
  alignas(64) Figures time{};  ///< s after the block's first shot
  alignas(64) Figures cos{};   ///< of the elevation
  alignas(64) Figures sin{};
  alignas(64) Figures cos_beside{};  ///< of `azimuth`
  alignas(64) Figures sin_beside{};
  alignas(64) Figures height{};  ///< m
  Figures azimuth{};             ///< deg
  std::array<std::uint8_t, kRecordsPerBlock> ring{};

  void set(std::size_t record, double seconds, const Laser& laser) {
    time[record] = seconds;
    cos[record] = std::cos(laser.elevation * kDegree);
    sin[record] = std::sin(laser.elevation * kDegree);
    cos_beside[record] = std::cos(laser.azimuth * kDegree);
    sin_beside[record] = std::sin(laser.azimuth * kDegree);
    height[record] = laser.height;
    azimuth[record] = laser.azimuth;
    ring[record] = laser.ring;
  }
};

}  // namespace curbstone::lidar::decoding
