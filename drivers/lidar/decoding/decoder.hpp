#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "drivers/lidar/packet/device_info.hpp"
#include "drivers/lidar/packet/refusal.hpp"

namespace curbstone::lidar::decoding {

struct DecoderOptions {
  double min_range = 0.4;    ///< m; nearer returns are left out
  double max_range = 150.0;  ///< m
};

/// The returns of one point packet, in the order in which they were fired. Frame: lidar (x forward, y left, z up). All
/// vectors have one element a return.
struct DecodedPacket {
  std::optional<std::int64_t> stamp;  ///< us since the Unix epoch on the device's clock, of the first shot; if sane
  int azimuth = 0;                    ///< 0.01 deg, clockwise, of the first shot
  double rate = 0;                    ///< 0.01 deg/s that the head turns
  double duration = 0;                ///< s from the first shot to when the next packet's is due
  int out_of_range = 0;               ///< returns that were left out

  std::vector<float> x, y, z;      ///< m
  std::vector<float> time_offset;  ///< s after the first shot
  std::vector<std::uint8_t> intensity;
  std::vector<std::uint8_t> ring;  ///< rank by elevation, 0 = lowest
};

/// RS-LiDAR-16 point packets (MSOP, single return) to points. Pure; one thread. Source: RS-LiDAR-16 user manual,
/// appendix A; rs_driver 4eeadace.
class Rs16Decoder {
 public:
  explicit Rs16Decoder(const DecoderOptions& options);

  /// What the device says about itself; nominal until then.
  void set_device(const packet::DeviceInfo& device);
  [[nodiscard]] const packet::DeviceInfo& device() const { return device_; }

  /// Overwrites `packet`, whose vectors keep their memory. Any bytes may come; `packet` means nothing when refused.
  [[nodiscard]] packet::Refusal decode(std::span<const std::uint8_t> bytes, DecodedPacket& packet) const;

 private:
  struct Laser {
    double cos = 1;  ///< of the elevation
    double sin = 0;
    std::uint8_t ring = 0;
  };
  void add_record(double azimuth_deg, double time, const Laser& laser, double range, std::uint8_t intensity,
                  DecodedPacket& packet) const;

  DecoderOptions options_;
  packet::DeviceInfo device_;
  std::array<Laser, packet::kLasers> lasers_;
};

}  // namespace curbstone::lidar::decoding
