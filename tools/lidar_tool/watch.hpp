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

/// Reports for each device, every second, whether it works properly. Pure: packets and times in, lines out.
class Watch {
 public:
  void on_packet(const Packet& packet);
  /// The lines of the second that ended by `now` (us); none during a second. A second without packets has a line too.
  [[nodiscard]] std::vector<std::string> on_time(std::int64_t now);

 private:
  struct Watched {
    std::unique_ptr<Sensor> sensor;  ///< null: not a LiDAR that this program supports
    lidar::models::Sender kind = lidar::models::Sender::kUnknown;
    std::int64_t packets = 0;  ///< in this second
    std::int64_t lost = 0;     ///< up to the previous second
    std::int64_t refused = 0;
  };
  [[nodiscard]] static std::string line_of(lidar::sources::Ipv4 address, Watched& watched);

  static constexpr std::size_t kMaxDevices = 32;
  std::map<lidar::sources::Ipv4, Watched> devices_;
  std::int64_t began_ = 0;  ///< us, start of the second; 0: none yet
};

}  // namespace curbstone::lidar_tool
