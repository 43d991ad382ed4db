#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "drivers/lidar/decoding/decoded_packet.hpp"

namespace curbstone::lidar::decoding {

inline constexpr double kDegree = std::numbers::pi / 180.0;

/// Which returns go out.
struct ReturnLimits {
  double min_range = 0.4;  ///< m; nearer returns are left out
  double max_range = 150.0;
  double start_angle = 0.0;  ///< deg, clockwise: returns from here ...
  double end_angle = 360.0;  ///< ... to before here; equal, or 0 and 360: all
};

/// One laser of a device, ready for use.
struct Laser {
  double cos = 1;  ///< of the elevation
  double sin = 0;
  double cos_beside = 1;  ///< of `azimuth`
  double sin_beside = 0;
  double azimuth = 0;     ///< deg that it looks beside the head's azimuth, clockwise
  double height = 0;      ///< m above the origin
  std::uint8_t ring = 0;  ///< rank by elevation, 0 = lowest
};
[[nodiscard]] inline Laser laser_at(double elevation_deg, double azimuth_deg, double height, std::uint8_t ring) {
  return {std::cos(elevation_deg * kDegree),
          std::sin(elevation_deg * kDegree),
          std::cos(azimuth_deg * kDegree),
          std::sin(azimuth_deg * kDegree),
          azimuth_deg,
          height,
          ring};
}

/// Turns the returns of a packet into points, in the order in which they are added. A sine and a cosine are taken once
/// a block; within it the head turns by at most 1 deg, for which four terms of the series are exact to 1e-15.
/// Use: construct it, then for each block block() and add(), then finish().
class PointWriter {
 public:
  static constexpr std::size_t kMost = 384;  ///< points of a packet: a record each, 12 blocks of 32

  /// `lens_offset`: m from the axis to the lenses, in the direction of the head's azimuth.
  PointWriter(const ReturnLimits& limits, double lens_offset, DecodedPacket& packet);

  /// `azimuth_deg` of the head at the block's first shot.
  void block(double azimuth_deg) {
    azimuth_deg_ = azimuth_deg;
    cos_ = std::cos(azimuth_deg * kDegree);
    sin_ = std::sin(azimuth_deg * kDegree);
  }
  /// `turned_deg`: by the head since the block's first shot; `time` s after the packet's.
  void add(double turned_deg, double time, const Laser& laser, double range, std::uint8_t intensity) {
    if (range < limits_.min_range || range > limits_.max_range) {
      ++packet_.out_of_range;
      return;
    }
    if (!whole_turn_ && !in_sector(azimuth_deg_ + turned_deg + laser.azimuth)) return;
    const double turned = turned_deg * kDegree;
    const double square = turned * turned;
    const double s = turned * (1.0 - square / 6.0 * (1.0 - square / 20.0));
    const double c = 1.0 - square / 2.0 * (1.0 - square / 12.0 * (1.0 - square / 30.0));
    const double cos_head = cos_ * c - sin_ * s;
    const double sin_head = sin_ * c + cos_ * s;
    const double cos_beam = cos_head * laser.cos_beside - sin_head * laser.sin_beside;
    const double sin_beam = sin_head * laser.cos_beside + cos_head * laser.sin_beside;
    const double flat = range * laser.cos;
    const std::size_t i = count_++;
    x_[i] = static_cast<float>(flat * cos_beam + lens_offset_ * cos_head);
    y_[i] = static_cast<float>(-flat * sin_beam - lens_offset_ * sin_head);
    z_[i] = static_cast<float>(range * laser.sin + laser.height);
    time_[i] = static_cast<float>(time);
    intensity_[i] = intensity;
    ring_[i] = laser.ring;
  }
  void finish();

 private:
  [[nodiscard]] bool in_sector(double azimuth_deg) const;

  ReturnLimits limits_;
  double lens_offset_;
  bool whole_turn_;
  DecodedPacket& packet_;
  float* x_;
  float* y_;
  float* z_;
  float* time_;
  std::uint8_t* intensity_;
  std::uint8_t* ring_;
  std::size_t count_ = 0;
  double azimuth_deg_ = 0;
  double cos_ = 1;
  double sin_ = 0;
};

}  // namespace curbstone::lidar::decoding
