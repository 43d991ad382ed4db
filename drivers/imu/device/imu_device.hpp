#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "common/bus/counters.hpp"
#include "drivers/link/link_state.hpp"

namespace curbstone::imu::device {

/// A measurement of the device at one instant. Frame: imu (the sensor's own axes, right-handed). Times in us.
struct ImuSample {
  std::int64_t received = 0;         ///< on the host's clock, minus the transmission time of its bytes
  std::optional<std::int64_t> time;  ///< on the device's clock, unwrapped and checked; empty if the device sends none
  bool restarted = false;            ///< that clock has restarted
  int missing = 0;                   ///< samples that are missing before this one
  std::array<double, 3> acceleration{};              ///< specific force, m/s^2
  std::array<double, 3> angular_rate{};              ///< rad/s
  std::optional<std::array<double, 4>> orientation;  ///< w x y z, unit, sensor to the device's local frame
  std::optional<double> temperature;                 ///< deg C
  bool force_clips = false;                          ///< an axis of the accelerometer is at the end of its range
  std::array<bool, 3> rate_clips{};                  ///< axes of the gyro at the end of their range
  std::optional<bool> self_test_passed;
  bool fine_steps = false;  ///< its steps are far below its noise: no two samples are equal
};

/// Settings that all models share.
struct DeviceSettings {
  bool configure = true;  ///< set the device up; false: nothing is sent
  int rate = 100;         ///< Hz
  bool orientation = true;
  std::int64_t patience = 1'000'000;  ///< us without a sample after which the device is set up again
  int baud = 115200;
  bool uart = false;  ///< a byte takes ten bits at that baud; otherwise the transmission time is negligible
};

/// Interface of an IMU model behind a byte stream: bytes in, samples and commands out. Pure: time is an argument, us.
/// One thread. Each model has a folder with a class that implements this.
class ImuDevice {
 public:
  using Handler = std::function<void(const ImuSample&)>;
  using Send = std::function<void(std::span<const std::uint8_t>)>;

  ImuDevice() = default;
  virtual ~ImuDevice() = default;
  ImuDevice(const ImuDevice&) = delete;
  ImuDevice& operator=(const ImuDevice&) = delete;

  virtual void on_bytes(std::int64_t now, std::span<const std::uint8_t> bytes, const Handler& handler) = 0;
  /// The link came up or went down: drops partly received messages and pending commands.
  virtual void on_link(std::int64_t now, link::LinkState state) = 0;
  virtual void tick(std::int64_t now) = 0;

  /// frames, garbage_bytes, refused.*, lost.packets, and the model's own counters.
  [[nodiscard]] virtual Counters counters() const = 0;
  /// The present fault in words; empty if there is none.
  [[nodiscard]] virtual std::string fault() const = 0;
};

}  // namespace curbstone::imu::device
