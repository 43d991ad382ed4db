#pragma once

#include "tools/simulate/devices/beam_table.hpp"
#include "tools/simulate/devices/lidar_emulator.hpp"

namespace curbstone::simulate::devices {

struct Vlp16EmulatorConfig {
  double rpm = 1200;
  ReturnMode mode = ReturnMode::kStrongest;
};

/// A Velodyne VLP-16 whose GPS has a fix. Source: VLP-16 User Manual 63-9243 Rev D, chapter 9.
class Vlp16Emulator final : public LidarEmulator {
 public:
  explicit Vlp16Emulator(const Vlp16EmulatorConfig& config = {});

  using LidarEmulator::add_firing;
  [[nodiscard]] const LidarTable& table() const override { return table_; }
  [[nodiscard]] std::vector<double> elevations_deg() const override { return beams_.elevations_deg(); }
  [[nodiscard]] double azimuth_step() const override { return beams_.rate() * table_.firing_period; }
  void beams(double azimuth_deg, std::span<LidarRay> by_laser) const override { beams_.beams(azimuth_deg, by_laser); }
  std::optional<Bytes> add_firing(std::int64_t utime, double azimuth_deg, Shots strongest, Shots last) override;
  void set_time(std::span<std::uint8_t> packet, std::int64_t utime) const override;
  /// The position packet.
  [[nodiscard]] Bytes info(std::int64_t utime) const override;

 private:
  void begin_packet(std::int64_t utime);
  void put_records(int block, int half, double azimuth_deg, Shots shots);

  ReturnMode mode_;
  LidarTable table_;
  BeamTable beams_;
  Bytes packet_;
  int firings_ = 0;
};

}  // namespace curbstone::simulate::devices
