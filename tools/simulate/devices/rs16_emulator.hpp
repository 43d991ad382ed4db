#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "drivers/lidar/models/rs16/msop_packet.hpp"

namespace curbstone::simulate::devices {

/// What one laser got back.
struct Rs16Shot {
  float range_m = 0;  ///< from the lens along the beam; <= 0 or beyond 327 m is no return
  std::uint8_t intensity = 0;
};

/// Where and when one laser of a firing sequence really looks: a target at range r is at `origin + r * direction`.
struct Rs16Ray {
  double time_offset = 0;  ///< s after the sequence's first shot
  Eigen::Vector3d origin;  ///< m in the lidar frame (x forward, y left, z up)
  Eigen::Vector3d direction;
};

struct Rs16EmulatorConfig {
  double rpm = 1200;
  /// deg, by laser in firing order: a device's own, slightly off the nominal table, so that DIFOP matters.
  lidar::models::rs16::ElevationTable elevations = {-15.0031, -12.9874, -11.0212, -8.9956, -7.0103, -4.9891,
                                                    -3.0067,  -0.9985,  14.9860,  12.9630, 11.0127, 8.9934,
                                                    7.0088,   4.9912,   3.0145,   1.0133};
};

/// Builds the packets of an RS-LiDAR-16 (single return, 5 mm, current firmware) from what its lasers measured. Pure:
/// whoever simulates casts the rays, keeps the time and sends the packets.
///
/// The sequences come every kSequencePeriod; the head turns `360 * rpm / 60 * kSequencePeriod` deg meanwhile. A packet
/// carries the time and the azimuths (0.01 deg) of its blocks' first shots only: a decoder interpolates the rest, which
/// is exact while the sequences keep that pace.
class Rs16Emulator {
 public:
  explicit Rs16Emulator(const Rs16EmulatorConfig& config = {});

  /// deg the head turns from one sequence to the next.
  [[nodiscard]] double azimuth_step() const { return rate_ * lidar::models::rs16::kSequencePeriod; }

  /// Beams of the sequence that starts at `azimuth_deg` (clockwise from above; 0 is x), by laser in firing order.
  [[nodiscard]] std::array<Rs16Ray, lidar::models::rs16::kLasers> rays(double azimuth_deg) const;

  /// Adds the sequence whose first shot is at `utime`. A packet comes out with the 24th.
  std::optional<lidar::models::rs16::Rs16Packet> add_sequence(
      std::int64_t utime, double azimuth_deg, std::span<const Rs16Shot, lidar::models::rs16::kLasers> by_laser);

  /// The device information packet; `rpm` 300, 600 or 1200.
  [[nodiscard]] lidar::models::rs16::Rs16Packet difop(std::int64_t utime, int rpm) const;

 private:
  struct Direction {
    double cos = 1;
    double sin = 0;
  };
  lidar::models::rs16::ElevationTable elevations_;
  std::array<Direction, lidar::models::rs16::kLasers> by_laser_;
  double rate_;  ///< deg/s
  lidar::models::rs16::MsopPacket packet_{};
  int sequences_ = 0;
};

}  // namespace curbstone::simulate::devices
