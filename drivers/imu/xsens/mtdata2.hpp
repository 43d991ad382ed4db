#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "common/bus/counters.hpp"

namespace curbstone::imu::xsens {

/// Content of one MTData2 message. Messages may differ in their items: an absent item is empty. Frame: imu (the
/// sensor's own axes, right-handed).
struct MtData2 {
  std::optional<std::uint16_t> packet_counter;
  std::optional<std::uint32_t> sample_time_fine;        ///< ticks of 0.1 ms
  std::optional<std::array<double, 3>> acceleration;    ///< specific force, m/s^2
  std::optional<std::array<double, 3>> angular_rate;    ///< rad/s
  std::optional<std::array<double, 3>> delta_velocity;  ///< m/s, of one sample interval
  std::optional<std::array<double, 4>> delta_rotation;  ///< w x y z, unit, of one sample interval
  std::optional<std::array<double, 4>> orientation;     ///< w x y z, unit, sensor to the device's local frame
  std::optional<double> temperature;                    ///< deg C
  std::optional<std::uint32_t> status;                  ///< bits of the status word; the status byte is its lowest
  bool truncated = false;                               ///< an item extends beyond the end: not a message of a device

  static constexpr std::uint32_t kSelfTestPassed = 1u << 0;
  static constexpr std::uint32_t kForceClips = 0x7u << 8;  ///< of the accelerometer's axes
  static constexpr std::uint32_t kRateClips = 1u << 11;    ///< of the gyroscope's x axis; y and z follow
};

/// Decodes the payload of an MTData2 message: float32, float64 and both fixed-point formats. Unknown items are skipped
/// by their size. Counts into `counters`: skipped.items, refused.truncated, refused.item_size, refused.not_finite,
/// refused.range (more than any such device can measure). Source: Xsens MT Low Level Communication Protocol (MT0101P),
/// MTData2.
[[nodiscard]] MtData2 decode_mtdata2(std::span<const std::uint8_t> payload, Counters& counters);

}  // namespace curbstone::imu::xsens
