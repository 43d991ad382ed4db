#pragma once

#include <cstdint>
#include <string>

#include "tools/bench/drivers/lidar_packets.hpp"
#include "tools/bench/drivers/serial_streams.hpp"
#include "tools/bench/timing/timed_in_turn.hpp"

namespace curbstone::bench::drivers {

/// How fast one LiDAR's packets are worked on, on one core.
struct LidarRate {
  std::string name;
  double pace = 0;             ///< point packets/s that the device sends
  double points_a_packet = 0;  ///< that go out
  double decode_per_s = 0;     ///< packets/s: bytes to points
  double driver_per_s = 0;     ///< packets/s: bytes to the encoded message, order and clock and all
  double memcpy_per_s = 0;     ///< packets/s: a copy of the same bytes
  [[nodiscard]] double ns_a_point() const { return 1e9 / decode_per_s / points_a_packet; }
  [[nodiscard]] double times_real() const { return decode_per_s / pace; }
  [[nodiscard]] double driver_times_real() const { return driver_per_s / pace; }
};

/// The same of a device on a serial line or a CAN bus. A unit is the bytes of a sample, or a frame.
struct StreamRate {
  std::string name;
  double pace = 0;   ///< units/s that the device sends
  double bytes = 0;  ///< a unit
  double driver_per_s = 0;
  double memcpy_per_s = 0;
  [[nodiscard]] double times_real() const { return driver_per_s / pace; }
};

/// Throws std::runtime_error where no packet gives points.
[[nodiscard]] LidarRate measure(const LidarPackets& packets, const timing::TurnOptions& turns);
[[nodiscard]] StreamRate measure(const std::string& name, imu::Model model, const std::vector<TimedBytes>& stream,
                                 const timing::TurnOptions& turns);
[[nodiscard]] StreamRate measure(const std::string& name, const std::vector<TimedFrame>& stream,
                                 const timing::TurnOptions& turns);

}  // namespace curbstone::bench::drivers
