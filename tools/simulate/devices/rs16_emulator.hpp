#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "drivers/lidar/models/rs16/msop_packet.hpp"
#include "tools/simulate/devices/lidar_emulator.hpp"

namespace curbstone::simulate::devices {

struct Rs16EmulatorConfig {
  double rpm = 1200;
  ReturnMode mode = ReturnMode::kStrongest;
  /// deg, by laser in firing order: those of a device, slightly off the nominal table, so that DIFOP matters.
  lidar::models::rs16::ElevationTable elevations = {-15.0031, -12.9874, -11.0212, -8.9956, -7.0103, -4.9891,
                                                    -3.0067,  -0.9985,  14.9860,  12.9630, 11.0127, 8.9934,
                                                    7.0088,   4.9912,   3.0145,   1.0133};
};

/// Builds the packets of an RS-LiDAR-16 (single or dual return, 5 mm, current firmware) from the returns of its lasers.
/// Pure: the simulator casts the rays, keeps the time and sends the packets.
///
/// The interval between sequences is kSequencePeriod; the head turns by `360 * rpm / 60 * kSequencePeriod` deg
/// meanwhile. A packet has only the time and the azimuths (0.01 deg) of its blocks' first shots: a decoder interpolates
/// the rest, which is exact while the sequences keep that interval.
class Rs16Emulator final : public LidarEmulator {
 public:
  explicit Rs16Emulator(const Rs16EmulatorConfig& config = {});

  /// deg the head turns from one sequence to the next.
  [[nodiscard]] double azimuth_step() const override { return rate_ * lidar::models::rs16::kSequencePeriod; }
  [[nodiscard]] const LidarTable& table() const override { return table_; }
  [[nodiscard]] std::vector<double> elevations_deg() const override;
  void beams(double azimuth_deg, std::span<LidarRay> by_laser) const override;
  using LidarEmulator::add_firing;
  std::optional<Bytes> add_firing(std::int64_t utime, double azimuth_deg, Shots strongest, Shots last) override;
  void set_time(std::span<std::uint8_t> packet, std::int64_t utime) const override;
  [[nodiscard]] Bytes info(std::int64_t utime) const override;

  /// Beams of the sequence that starts at `azimuth_deg` (clockwise from above; 0 is x), by laser in firing order.
  [[nodiscard]] std::array<LidarRay, lidar::models::rs16::kLasers> rays(double azimuth_deg) const;

  /// Adds the sequence whose first shot is at `utime`, for a device with single return. Returns a packet with every
  /// 24th sequence.
  std::optional<lidar::models::rs16::Rs16Packet> add_sequence(
      std::int64_t utime, double azimuth_deg, std::span<const LidarShot, lidar::models::rs16::kLasers> by_laser);

  /// The device information packet; `rpm` 300, 600 or 1200.
  [[nodiscard]] lidar::models::rs16::Rs16Packet difop(std::int64_t utime, int rpm) const;

 private:
  struct Direction {
    double cos = 1;
    double sin = 0;
  };
  lidar::models::rs16::ElevationTable elevations_;
  using Laser16 = std::span<const LidarShot, lidar::models::rs16::kLasers>;
  std::optional<lidar::models::rs16::Rs16Packet> add_dual(std::int64_t utime, double azimuth_deg, Laser16 strongest,
                                                          Laser16 last);
  void begin_packet(std::int64_t utime);
  void put(std::size_t block, std::size_t half, Laser16 by_laser);

  std::array<Direction, lidar::models::rs16::kLasers> by_laser_;
  double rate_;  ///< deg/s
  ReturnMode mode_;
  LidarTable table_;
  lidar::models::rs16::MsopPacket packet_{};
  int sequences_ = 0;
};

}  // namespace curbstone::simulate::devices
