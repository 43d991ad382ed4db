#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "common/time/recent_times.hpp"
#include "drivers/encoder/can/can_frame.hpp"
#include "drivers/encoder/canopen/sdo_client.hpp"

namespace curbstone::encoder::canopen {

/// What the drive reports of itself. Index 0 is the left wheel, 1 the right.
struct DriveStatus {
  std::array<std::uint16_t, 2> word{};    ///< CiA 402 status words
  std::int64_t word_utime = 0;            ///< us, when they last came; 0: not since the drive was last set up
  std::array<std::int16_t, 2> speed{};    ///< 0.1 rpm, came with the status words
  std::array<std::uint16_t, 2> faults{};  ///< 603F: bits; only asked for by who sets the drive up
  std::int64_t faults_utime = 0;          ///< us, when they were last read; 0: not since then
  std::uint16_t emergency = 0;            ///< error code of the last EMCY; 0: none, or it is over
  std::uint8_t error_register = 0;        ///< 1001, as that EMCY had it

  /// Both wheels powered (operation enabled) and free of alarms, at the last status that is not older than kOldStatus.
  [[nodiscard]] bool enabled(std::int64_t now) const;
  static constexpr std::int64_t kOldStatus = 2'000'000;  ///< us
};

/// The master of a ZLAC8015D two-wheel drive on CANopen. Set-up: pre-operational, PDO mapping by SDO, start. Then it
/// watches boot-ups, heartbeats and silence. After a restart, a stop by another master or a silence it sets the drive
/// up again. It never moves a wheel. A drive whose status, fault word or heartbeat stays away has a fault, too: what is
/// not known is not good. Pure: time comes in (us), frames go in and out. TPDO1 carries both positions, TPDO2 status
/// and speeds. Source: CiA 301, CiA 402; ZLAC8015D CANopen manual.
///
/// The positions that come first after it has started the drive are left out: they answer the start, and the event
/// timer begins later. Counts: drive.setups, drive.boots, drive.silences, drive.stops (left operational without us),
/// drive.emergencies, ignored.frames, ignored.unconfigured, ignored.first, refused.length, and those of SdoClient.
class WheelDrive {
 public:
  struct Settings {
    std::uint8_t node = 1;
    bool configure = true;                ///< false: another master sets the drive up, only listen
    std::int64_t period = 10'000;         ///< us, of the positions
    std::int64_t event_timer_unit = 500;  ///< us; the ZLAC's, the standard says 1000
    std::int64_t patience = 500'000;      ///< us without positions after which the drive is set up again
    std::int64_t heartbeat_period = 250;  ///< in the drive's own unit (1 ms or, measured, 0.5 ms)
  };
  struct Handlers {
    std::function<void(const can::CanFrame&)> send;
    std::function<void(std::int64_t receive_utime, std::array<std::int32_t, 2> counts)> on_counts;
    std::function<void()> on_restart;       ///< the drive has booted: its counts begin anew
    std::function<void()> on_stop = [] {};  ///< the positions that come next keep another beat
  };

  WheelDrive(const Settings& settings, Handlers handlers);

  /// (Re)starts from the beginning: the link came up.
  void start(std::int64_t now);
  void on_frame(std::int64_t receive_utime, const can::CanFrame& frame);
  void tick(std::int64_t now);

  [[nodiscard]] const DriveStatus& status() const { return status_; }
  /// Encoder lines of the left wheel's motor (200E), once read.
  [[nodiscard]] std::optional<std::uint32_t> encoder_lines() const { return encoder_lines_; }
  /// What is wrong, in words, with the communication and by what the drive says of itself, except the bits of its fault
  /// word; empty when nothing is.
  [[nodiscard]] std::vector<std::string> faults() const;
  /// Frames that were refused.
  [[nodiscard]] std::int64_t refused() const { return counters_["refused.length"]; }
  [[nodiscard]] Counters counters() const;
  /// The CAN ids that a source must let through.
  [[nodiscard]] static std::vector<std::uint32_t> ids(std::uint8_t node);

 private:
  struct Write {
    canopen::Object object;
    std::uint8_t size;
    std::uint32_t value;
    bool required;
  };
  enum class State { kIdle, kSettingUp, kRunning, kFailed };

  [[nodiscard]] std::vector<Write> setup_sequence() const;
  void restart(std::int64_t now);
  void next_write(std::int64_t now);
  void run(std::int64_t now);
  void fail(std::int64_t now, std::string why);
  void on_heartbeat(std::int64_t now, const can::CanFrame& frame);
  void on_emergency(const can::CanFrame& frame);
  void poll(std::int64_t now);

  Settings settings_;
  Handlers handlers_;
  SdoClient sdo_;
  State state_ = State::kIdle;
  std::vector<Write> sequence_;
  std::size_t step_ = 0;
  std::int64_t since_ = 0;        // when the state began
  bool answers_start_ = false;    // the positions that come next
  std::int64_t last_counts_ = 0;  // when positions last came, or the drive was started
  std::int64_t last_poll_ = 0;
  std::int64_t last_tick_ = 0;
  std::int64_t began_ = 0;                       // when the link came up
  std::int64_t last_heartbeat_ = 0;              // 0: none came since then
  NmtState nmt_state_ = NmtState::kOperational;  // by the last heartbeat
  bool poll_now_ = false;
  DriveStatus status_;
  static constexpr std::size_t kManyBoots = 3;  // within a minute
  RecentTimes boots_{kManyBoots, 60'000'000};
  std::optional<std::uint32_t> encoder_lines_;
  std::string fault_;
  Counters counters_;
};

}  // namespace curbstone::encoder::canopen
