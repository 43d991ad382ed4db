#pragma once

#include <cstdint>
#include <vector>

#include "drivers/encoder/can/can_frame.hpp"
#include "drivers/imu/imu_config.hpp"

namespace curbstone::bench::drivers {

/// The bytes of one sample of an IMU, and when they came, us since the Unix epoch.
struct TimedBytes {
  std::int64_t received = 0;
  std::vector<std::uint8_t> bytes;
};

struct TimedFrame {
  std::int64_t received = 0;
  encoder::can::CanFrame frame;
};

/// `seconds` of an emulated IMU that is set up: an MTi at 100 Hz, a WitMotion at 200 Hz.
[[nodiscard]] std::vector<TimedBytes> imu_stream(imu::Model model, double seconds);

/// `seconds` of all that an emulated ZLAC8015D sends while EncoderNode sets it up and listens: positions each 10 ms,
/// status, heartbeat, answers.
[[nodiscard]] std::vector<TimedFrame> encoder_stream(double seconds);

}  // namespace curbstone::bench::drivers
