#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "drivers/encoder/can/can_frame.hpp"
#include "drivers/encoder/canopen/canopen.hpp"

namespace curbstone::simulate::devices {

/// A ZLAC8015D wheel drive seen from the CAN bus: boot-up, NMT, SDO server, heartbeat, two TPDOs with event and inhibit
/// timers, EMCY. A frame state machine without a clock: the caller passes the time (us, any monotonic clock).
///
/// Usage: set_counts() to the true counts at that time, then on_frame() with each frame from the host (a start command
/// is answered with positions at once) or, at next_due(), tick(). Settings that a power cycle or a reset loses are lost
/// here too.
class CanDriveEmulator {
 public:
  struct Settings {
    std::uint8_t node = 1;
    std::int64_t event_timer_unit = 500;  ///< us; of the ZLAC; the standard says 1000
    std::int64_t heartbeat_unit = 500;    ///< us; as measured; the manual says 1000
    double clock_error = 0.0;             ///< of the drive's oscillator: 50e-6 is 50 ppm fast
  };
  using Frames = std::vector<encoder::can::CanFrame>;

  explicit CanDriveEmulator(const Settings& settings);
  CanDriveEmulator() : CanDriveEmulator(Settings{}) {}

  /// Switches the supply on, or off and on: counts start at 0, the configuration is lost. Sends boot-up.
  Frames power_on(std::int64_t now);
  /// Takes a frame from the bus; returns the responses. Frames for other nodes are ignored.
  Frames on_frame(std::int64_t now, const encoder::can::CanFrame& frame);
  /// Everything that is due up to `now`: TPDOs, heartbeat.
  Frames tick(std::int64_t now);
  /// us, when tick() is due next; empty while no timer runs.
  [[nodiscard]] std::optional<std::int64_t> next_due() const;

  /// Encoder counts in the drive's convention (raw: the right wheel is mounted mirrored). They wrap as int32.
  void set_counts(std::int32_t left, std::int32_t right);
  /// 0.1 rpm, raw.
  void set_speeds(std::int16_t left, std::int16_t right);
  /// Whether the motors are enabled. Status word 0x27 (operation enabled), else 0x21 (ready).
  void set_enabled(bool enabled);
  /// A fault (603F bits) on a wheel, 0 clears: sends EMCY.
  Frames set_faults(std::uint16_t left, std::uint16_t right);

  [[nodiscard]] encoder::canopen::NmtState state() const { return state_; }

 private:
  struct Entry {
    std::uint8_t size;  // bytes
    bool writable;
    std::uint32_t value;
  };
  struct Pdo {
    std::uint32_t id;
    std::uint16_t communication;  // index of its parameters: 1800, 1801
    std::int64_t last_sent = 0;
    std::vector<std::uint8_t> last_data;
  };

  void load_defaults();
  encoder::can::CanFrame answer_sdo(const encoder::can::CanFrame& request);
  void enter(encoder::canopen::NmtState state, std::int64_t now);
  [[nodiscard]] encoder::can::CanFrame heartbeat(encoder::canopen::NmtState state) const;
  [[nodiscard]] encoder::can::CanFrame emergency() const;
  [[nodiscard]] std::vector<std::uint8_t> pdo_data(const Pdo& pdo) const;
  [[nodiscard]] std::optional<std::int64_t> due(const Pdo& pdo) const;
  [[nodiscard]] std::optional<std::int64_t> heartbeat_due() const;
  [[nodiscard]] std::uint32_t value(std::uint16_t index, std::uint8_t sub) const;
  void set(std::uint16_t index, std::uint8_t sub, std::uint32_t value);
  [[nodiscard]] std::int64_t device_time(double us) const;
  void update_status();

  Settings settings_;
  encoder::canopen::NmtState state_ = encoder::canopen::NmtState::kStopped;
  bool powered_ = false;
  bool enabled_ = false;
  std::map<encoder::canopen::Object, Entry> dictionary_;
  std::vector<Pdo> pdos_;
  std::int64_t last_heartbeat_ = 0;
};

}  // namespace curbstone::simulate::devices
