#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

#include "common/bus/counters.hpp"

namespace curbstone {

/// The counters of SERVICE_STATUS that are levels: present values, which rise and fall. All other counters only grow
/// from the start of the process. The message does not distinguish the two, so a name is a level in every process or in
/// none. The READMEs mark them (level); tests/docs/check_counters compares the marks with this list. Sorted.
inline constexpr auto kLevels = std::to_array<std::string_view>({
    "clock.device",
    "clock.difference_us",
    "clock.drift_ppm",
    "clock.host_synchronised",
    "commands.running",
    "dense.points",
    "device.dual_return",
    "device.gprmc_locked",
    "device.pps",
    "device.pps_locked",
    "device.rpm",
    "device.rpm_set",
    "device.supply_1v2_mv",
    "device.supply_2v5_mv",
    "device.supply_3v3_mv",
    "device.supply_5v_mv",
    "device.sync_mode",
    "device.sync_status",
    "device.temperature_1_mdeg",
    "device.temperature_2_mdeg",
    "device.temperature_3_mdeg",
    "device.temperature_4_mdeg",
    "far.disk_kb",
    "far.memory_kb",
    "far.unreadable",
    "foxglove.clients",
    "imu.accelerometer_noise_percent",
    "imu.gyro_noise_percent",
    "lidar.lag_ms",
    "memory.own_kb",
    "modbus.round_trip_us",
    "pages",
    "serial.baud",
    "serial.latency_timer_ms",
    "serial.low_latency",
    "stamp.uncertainty_us",
    "steps_stale",
    "store.failing",
    "tiles",
    "tiles_behind",
    "tiles_waiting",
});
static_assert(std::is_sorted(kLevels.begin(), kLevels.end()));

/// Levels whose last word is a text, because SERVICE_STATUS has a number for each name and no text: a device with
/// serial number 33C1160BAAA reports "device.serial_number.33C1160BAAA", which is 1. The READMEs call that word HEX.
/// Sorted.
inline constexpr auto kTextLevels = std::to_array<std::string_view>({
    "device.firmware",
    "device.firmware_bottom",
    "device.serial_number",
});
static_assert(std::is_sorted(kTextLevels.begin(), kTextLevels.end()));

[[nodiscard]] constexpr bool is_level(std::string_view name) {
  const std::string_view beginning = name.substr(0, name.find_last_of('.'));
  return std::binary_search(kLevels.begin(), kLevels.end(), name) ||
         (beginning.size() < name.size() && std::binary_search(kTextLevels.begin(), kTextLevels.end(), beginning));
}

/// A name in kLevels. Any other name does not compile.
class LevelName {
 public:
  consteval LevelName(const char* name) : name_(name) {  // NOLINT(google-explicit-constructor): stands for the name
    if (!is_level(name_)) throw std::invalid_argument("not in kLevels");
  }
  [[nodiscard]] constexpr std::string_view text() const { return name_; }

 private:
  std::string_view name_;
};

/// A name in kTextLevels. Any other name does not compile.
class TextLevelName {
 public:
  consteval TextLevelName(const char* name) : name_(name) {  // NOLINT(google-explicit-constructor): stands for the name
    if (!std::binary_search(kTextLevels.begin(), kTextLevels.end(), name_))
      throw std::invalid_argument("not in kTextLevels");
  }
  [[nodiscard]] constexpr std::string_view text() const { return name_; }

 private:
  std::string_view name_;
};

/// Sets a counter that is a level to its present value.
inline void set_level(Counters& counters, LevelName name, std::int64_t value) {
  counters.set(name.text(), value);
}

/// Sets the level that has this text; an empty text is none. The text is a word of letters and digits.
inline void set_text(Counters& counters, TextLevelName name, std::string_view text) {
  if (!text.empty()) counters.set(std::string(name.text()) + "." + std::string(text), 1);
}

}  // namespace curbstone
