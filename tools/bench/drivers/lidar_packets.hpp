#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "drivers/lidar/models/make_model.hpp"

namespace curbstone::bench::drivers {

/// A UDP packet and when it came, us since the Unix epoch.
struct TimedPacket {
  std::int64_t received = 0;
  std::vector<std::uint8_t> bytes;
};

/// What one LiDAR sent.
struct LidarPackets {
  std::string name;  ///< of the model, or of the capture's file
  lidar::models::ModelName model = lidar::models::ModelName::kRs16;
  std::vector<TimedPacket> infos;   ///< what the device says of itself
  std::vector<TimedPacket> points;  ///< at least two

  /// Point packets a second, at the pace at which the device sent them.
  [[nodiscard]] double pace() const;
};

/// `seconds` of an emulated device at 20 Hz. Of its shots 85 % have a return, at random; the ranges are those of a
/// street, 2 to 40 m.
[[nodiscard]] LidarPackets emulated_packets(lidar::models::ModelName model, double seconds);

/// Those of a capture. Throws std::runtime_error, one line, where it has none of a LiDAR that the driver speaks.
[[nodiscard]] LidarPackets captured_packets(const std::string& file);

}  // namespace curbstone::bench::drivers
