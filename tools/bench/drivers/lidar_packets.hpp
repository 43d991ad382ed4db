#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "drivers/lidar/models/make_model.hpp"

namespace curbstone::bench::drivers {

/// A UDP packet and its time of reception, us since the Unix epoch.
struct TimedPacket {
  std::int64_t received = 0;
  std::vector<std::uint8_t> bytes;
};

/// The packets of one LiDAR.
struct LidarPackets {
  std::string name;  ///< of the model, or of the capture file
  lidar::models::ModelName model = lidar::models::ModelName::kRs16;
  std::vector<TimedPacket> infos;   ///< device information packets
  std::vector<TimedPacket> points;  ///< at least two

  /// Point packets per second, at the device's rate.
  [[nodiscard]] double pace() const;
};

/// `seconds` of an emulated device at 20 Hz. A random 85 % of its shots have a return, at ranges typical of a street, 2
/// to 40 m.
[[nodiscard]] LidarPackets emulated_packets(lidar::models::ModelName model, double seconds);

/// The packets of a capture. Throws std::runtime_error with a one-line message if it has none of a supported LiDAR.
[[nodiscard]] LidarPackets captured_packets(const std::string& file);

}  // namespace curbstone::bench::drivers
