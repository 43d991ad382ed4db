#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/counters.hpp"
#include "common/time/recent_times.hpp"
#include "drivers/encoder/can/can_frame.hpp"
#include "drivers/encoder/canopen/latest_pdos.hpp"
#include "drivers/encoder/canopen/nodes_heard.hpp"
#include "drivers/encoder/canopen/sdo_client.hpp"

namespace curbstone::encoder::canopen {

/// Status as reported by the drive. Index 0 is the left wheel, 1 the right.
struct DriveStatus {
  std::array<std::uint16_t, 2> word{};    ///< CiA 402 status words, as two frames in a row say
  std::int64_t word_utime = 0;            ///< us, of the latest ones; 0: none since the latest set-up
  std::array<std::int16_t, 2> speed{};    ///< 0.1 rpm, received with the status words
  std::array<std::uint16_t, 2> faults{};  ///< 603F: bits; only requested if this master sets the drive up
  std::int64_t faults_utime = 0;          ///< us, of the latest reading; 0: none since the latest set-up
  std::uint16_t emergency = 0;            ///< error code of the latest EMCY; 0: none, or it is over
  std::uint8_t error_register = 0;        ///< 1001, from that EMCY

  /// Both wheels are powered (operation enabled) and free of alarms, by a status that is not older than kOldStatus.
  [[nodiscard]] bool enabled(std::int64_t now) const;
  static constexpr std::int64_t kOldStatus = 2'000'000;  ///< us
};

/// CANopen master of a ZLAC8015D two-wheel drive. Set-up: pre-operational, PDO mapping by SDO, start. After that it
/// watches boot-ups, heartbeats and silence, and repeats the set-up after a restart, a stop by another master or a
/// silence. It never moves a wheel. A missing status, fault word or heartbeat is a fault, too. Pure: time (us) and
/// frames are arguments, output goes to the handlers. TPDO1 carries both positions, TPDO2 status and speeds. Source:
/// CiA 301, CiA 402; ZLAC8015D CANopen manual.
///
/// On a line without a checksum (SLCAN) a digit may be damaged in any frame: what an SDO reads counts when it was read
/// twice, and a state in a heartbeat, other than a boot-up, when two heartbeats in a row say so, and so do the states
/// in the status words. An EMCY is sent once. It is refused if its error register has no error, or if it is a TPDO by
/// its contents.
///
/// The first positions after a start of the drive are ignored, and the same again at once: they answer the start, and
/// the event timer begins later. Counts: drive.setups, drive.boots, drive.silences, drive.stops (left operational
/// without this master's command), drive.emergencies, ignored.frames, ignored.unconfigured, ignored.first,
/// refused.length, refused.heartbeat (a state that CANopen does not have), refused.emergency, and those of SdoClient.
class WheelDrive {
 public:
  struct Settings {
    std::uint8_t node = 1;
    bool configure = true;                ///< false: another master sets the drive up, this one only listens
    std::int64_t period = 10'000;         ///< us, between positions
    std::int64_t event_timer_unit = 500;  ///< us; that of a ZLAC, the standard says 1000
    std::int64_t patience = 500'000;      ///< us without positions after which the drive is set up again
    std::int64_t heartbeat_period = 250;  ///< in the drive's own unit (1 ms or, measured, 0.5 ms)
  };
  struct Handlers {
    std::function<void(const can::CanFrame&)> send;
    std::function<void(std::int64_t receive_utime, std::array<std::int32_t, 2> counts)> on_counts;
    std::function<void()> on_restart;       ///< it says that the drive has booted: its counts restart
    std::function<void()> on_stop = [] {};  ///< the next positions have another phase
  };

  WheelDrive(const Settings& settings, Handlers handlers);

  /// (Re)starts from the beginning, when the link came up: what the drive reported before is forgotten.
  void start(std::int64_t now);
  void on_frame(std::int64_t receive_utime, const can::CanFrame& frame);
  void tick(std::int64_t now);

  [[nodiscard]] const DriveStatus& status() const { return status_; }
  /// Encoder lines of the left wheel's motor (200E), once read.
  [[nodiscard]] std::optional<std::uint32_t> encoder_lines() const { return encoder_lines_; }
  /// Faults of the communication and of the drive by its own report, in words, without the bits of its fault word;
  /// empty if there are none.
  [[nodiscard]] std::vector<std::string> faults() const;
  /// "; heard instead: CAN node 2", while nothing is heard of this drive since the link came up; else empty.
  [[nodiscard]] std::string heard_instead() const { return is_heard_ ? "" : nodes_.instead_of(settings_.node); }
  /// Why the latest frame was refused: the counter's name; nullptr if it was not.
  [[nodiscard]] const char* refusal() const { return refusal_; }
  [[nodiscard]] Counters counters() const;
  /// The CAN ids that a source must pass on.
  [[nodiscard]] static std::vector<std::uint32_t> ids(std::uint8_t node);

 private:
  struct Write {
    canopen::Object object;
    std::uint8_t size;
    std::uint32_t value;
    bool required;
  };
  enum class State { kIdle, kSettingUp, kRunning, kFailed };
  /// A value that was read twice in a row.
  struct TwiceRead {
    std::optional<std::uint32_t> latest;
    bool add(std::uint32_t value) { return std::exchange(latest, value) == value; }
  };

  [[nodiscard]] std::vector<Write> setup_sequence() const;
  [[nodiscard]] bool is_from_drive(const can::CanFrame& frame) const;
  void restart(std::int64_t now);
  void next_write(std::int64_t now);
  void run(std::int64_t now);
  void fail(std::int64_t now, std::string why);
  void on_heartbeat(std::int64_t now, const can::CanFrame& frame);
  void on_status(std::int64_t now, const can::CanFrame& frame);
  void on_emergency(const can::CanFrame& frame);
  void poll(std::int64_t now);
  void refuse(const char* cause);

  Settings settings_;
  Handlers handlers_;
  SdoClient sdo_;
  State state_ = State::kIdle;
  std::vector<Write> sequence_;
  std::size_t step_ = 0;
  std::int64_t since_ = 0;               // begin of the state
  bool answers_start_ = false;           // the next positions answer a start
  std::optional<can::CanFrame> answer_;  // these, until others were received: they may come twice
  std::int64_t answered_ = 0;
  std::int64_t last_counts_ = 0;  // when positions were last received, or the drive was started
  std::int64_t last_poll_ = 0;
  std::int64_t last_tick_ = 0;
  std::int64_t began_ = 0;                       // when the link came up
  std::int64_t last_heartbeat_ = 0;              // 0: none since then
  NmtState nmt_state_ = NmtState::kOperational;  // by the latest two heartbeats
  NmtState latest_state_ = NmtState::kOperational;
  bool poll_now_ = false;
  DriveStatus status_;
  LatestPdos pdos_;
  std::optional<std::array<std::uint16_t, 2>> latest_words_;  // since the latest set-up
  static constexpr std::size_t kManyBoots = 3;                // within a minute
  RecentTimes boots_{kManyBoots, 60'000'000};
  std::optional<std::uint32_t> encoder_lines_;
  TwiceRead lines_read_, faults_read_;
  NodesHeard nodes_;
  bool is_heard_ = false;  // any frame of the drive, since the link came up
  std::string fault_;
  const char* refusal_ = nullptr;
  Counters counters_;
};

}  // namespace curbstone::encoder::canopen
