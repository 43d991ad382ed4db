#pragma once

#include <cstdint>
#include <vector>

#include "drivers/encoder/can/can_frame.hpp"
#include "drivers/imu/imu_config.hpp"

namespace curbstone::bench::drivers {

/// The bytes of one IMU sample and their time of reception, us since the Unix epoch.
struct TimedBytes {
  std::int64_t received = 0;
  std::vector<std::uint8_t> bytes;
};

struct TimedFrame {
  std::int64_t received = 0;
  encoder::can::CanFrame frame;
};

/// `seconds` of a configured emulated IMU: an MTi at 100 Hz, a WitMotion at 200 Hz.
[[nodiscard]] std::vector<TimedBytes> imu_stream(imu::Model model, double seconds);

/// `seconds` of everything that an emulated ZLAC8015D sends while EncoderNode configures it and listens: positions
/// every 10 ms, status, heartbeat, responses.
[[nodiscard]] std::vector<TimedFrame> encoder_stream(double seconds);

}  // namespace curbstone::bench::drivers
