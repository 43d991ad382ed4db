#pragma once

#include "tools/simulate/devices/beam_table.hpp"
#include "tools/simulate/devices/lidar_emulator.hpp"

namespace curbstone::simulate::devices {

/// The direction of a laser of a Helios, in steps of 0.01 deg.
struct HeliosAngles {
  double elevation = 0;  ///< deg above the horizon
  double azimuth = 0;    ///< deg relative to the head's azimuth, clockwise
};

struct HeliosEmulatorConfig {
  int lasers = 16;  ///< 16 (16P) or 32
  double rpm = 1200;
  ReturnMode mode = ReturnMode::kStrongest;
  std::vector<HeliosAngles> angles;  ///< by laser; empty: those of a sample device
};

/// A RoboSense RS-Helios with 16 lasers (16P) or 32, with its GPS locked. The order of the halves of a dual packet is
/// not documented: here the strongest comes first. Source: RS-Helios-16P user manual; rs_driver 4eeadace; the recording
/// shared/data/rs16/helios16p.pcap, which is of 32 lasers.
class HeliosEmulator final : public LidarEmulator {
 public:
  explicit HeliosEmulator(const HeliosEmulatorConfig& config);

  using LidarEmulator::add_firing;
  [[nodiscard]] const LidarTable& table() const override { return table_; }
  [[nodiscard]] std::vector<double> elevations_deg() const override { return beams_.elevations_deg(); }
  [[nodiscard]] double azimuth_step() const override { return beams_.rate() * table_.firing_period; }
  void beams(double azimuth_deg, std::span<LidarRay> by_laser) const override { beams_.beams(azimuth_deg, by_laser); }
  std::optional<Bytes> add_firing(std::int64_t utime, double azimuth_deg, Shots strongest, Shots last) override;
  void set_time(std::span<std::uint8_t> packet, std::int64_t utime) const override;
  /// The DIFOP packet.
  [[nodiscard]] Bytes info(std::int64_t utime) const override;

 private:
  void begin_packet(std::int64_t utime);
  void put_firing(double azimuth_deg, Shots strongest, Shots last);
  void put_block(int block, double azimuth_deg);
  void put_records(int block, int first_record, Shots shots);

  HeliosEmulatorConfig config_;
  LidarTable table_;
  BeamTable beams_;
  Bytes packet_;
  int firings_ = 0;
  std::uint32_t packets_ = 0;
};

}  // namespace curbstone::simulate::devices
