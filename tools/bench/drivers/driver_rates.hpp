#pragma once

#include <cstdint>
#include <string>

#include "tools/bench/drivers/lidar_packets.hpp"
#include "tools/bench/drivers/serial_streams.hpp"
#include "tools/bench/timing/interleaved_timing.hpp"

namespace curbstone::bench::drivers {

/// Processing rates of one LiDAR's packets on one core.
struct LidarRate {
  std::string name;
  double pace = 0;             ///< point packets/s of the device
  double points_a_packet = 0;  ///< output points
  double decode_per_s = 0;     ///< packets/s, from bytes to points
  double driver_per_s = 0;     ///< packets/s, from bytes to the encoded message, with packet order and clock
  double memcpy_per_s = 0;     ///< packets/s, copying the same bytes
  [[nodiscard]] double ns_a_point() const { return 1e9 / decode_per_s / points_a_packet; }
  [[nodiscard]] double times_real() const { return decode_per_s / pace; }
  [[nodiscard]] double driver_times_real() const { return driver_per_s / pace; }
};

/// The same for a device on a serial line or a CAN bus. A unit is the bytes of a sample, or a frame.
struct StreamRate {
  std::string name;
  double pace = 0;   ///< units/s of the device
  double bytes = 0;  ///< per unit
  double driver_per_s = 0;
  double memcpy_per_s = 0;
  [[nodiscard]] double times_real() const { return driver_per_s / pace; }
};

/// Throws std::runtime_error if no packet gives points.
[[nodiscard]] LidarRate measure(const LidarPackets& packets, const timing::TurnOptions& turns);
[[nodiscard]] StreamRate measure(const std::string& name, imu::Model model, const std::vector<TimedBytes>& stream,
                                 const timing::TurnOptions& turns);
[[nodiscard]] StreamRate measure(const std::string& name, const std::vector<TimedFrame>& stream,
                                 const timing::TurnOptions& turns);

}  // namespace curbstone::bench::drivers
