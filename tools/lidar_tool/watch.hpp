#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tools/lidar_tool/devices.hpp"
#include "tools/lidar_tool/packets.hpp"
#include "tools/lidar_tool/sensor.hpp"

namespace curbstone::lidar_tool {

/// Says each second, of each device, whether it is sane. Pure: packets and times go in, lines come out.
class Watch {
 public:
  void on_packet(const Packet& packet);
  /// The lines of the second that has ended by `now` (us); none while it lasts. A second in which nothing came has a
  /// line as well.
  [[nodiscard]] std::vector<std::string> on_time(std::int64_t now);

 private:
  struct Watched {
    std::unique_ptr<Sensor> sensor;  ///< none: not a LiDAR that this program reads
    lidar::models::Sender kind = lidar::models::Sender::kUnknown;
    std::int64_t packets = 0;  ///< of this second
    std::int64_t lost = 0;     ///< up to the second before
    std::int64_t refused = 0;
  };
  [[nodiscard]] static std::string line_of(lidar::sources::Ipv4 address, Watched& watched);

  static constexpr std::size_t kMostDevices = 32;
  std::map<lidar::sources::Ipv4, Watched> devices_;
  std::int64_t began_ = 0;  ///< us, the second; 0: none yet
};

}  // namespace curbstone::lidar_tool
