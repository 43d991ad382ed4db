#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "drivers/lidar/models/base/sender.hpp"
#include "drivers/lidar/models/make_model.hpp"
#include "tools/lidar_tool/packets.hpp"

namespace curbstone::lidar_tool {

/// Packets of one kind to one port.
struct Stream {
  int port = 0;
  lidar::models::Sender kind = lidar::models::Sender::kUnknown;
  std::int64_t packets = 0;
  std::size_t shortest = 0;  ///< bytes
  std::size_t longest = 0;
  std::int64_t first = 0;  ///< us since the Unix epoch
  std::int64_t last = 0;
  [[nodiscard]] double seconds() const { return static_cast<double>(last - first) * 1e-6; }
  /// packets/s; 0 for fewer than two packets.
  [[nodiscard]] double rate() const;
};

/// A sender: a LiDAR or another device.
struct Device {
  lidar::sources::Ipv4 address = 0;
  std::vector<Stream> streams;  ///< the one with the most packets first
  /// The model, if it sends points that this driver supports.
  std::optional<lidar::models::ModelName> model;
  [[nodiscard]] std::int64_t packets() const;
};

/// The model that sends packets of this kind, if this driver supports it. A Helios whose packets do not state the
/// number of lasers is taken for a 16P; devices_in() asks its device information too.
[[nodiscard]] std::optional<lidar::models::ModelName> model_of(lidar::models::Sender kind);

/// By the model's name in the configuration.
[[nodiscard]] std::optional<lidar::models::ModelName> model_named(const std::string& name);

/// All senders and their streams, those with the most packets first. One pass.
[[nodiscard]] std::vector<Device> devices_in(const Packets& packets);

}  // namespace curbstone::lidar_tool
