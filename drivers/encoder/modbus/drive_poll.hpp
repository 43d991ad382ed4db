#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "common/bus/counters.hpp"
#include "common/bus/refusal_share.hpp"
#include "drivers/encoder/modbus/modbus_client.hpp"

namespace curbstone::encoder::modbus {

/// Both wheels at one instant, with the latest state of the drive. Index 0 is the left wheel.
struct Reading {
  std::int64_t utime = 0;       ///< us since the Unix epoch, middle between request and reply
  std::int64_t time = 0;        ///< the same instant by the steady clock, us: the host's clock may be set in between
  std::int64_t round_trip = 0;  ///< us; the counts were sampled within it, so the stamp is accurate to half of it
  std::array<std::int32_t, 2> counts{};
  std::optional<std::array<std::int16_t, 2>> speeds = std::nullopt;  ///< 0.1 rpm, read with the counts
  std::array<std::uint16_t, 2> faults{};                             ///< bits, as 603F of the CAN drive
  std::int64_t faults_time = 0;                                      ///< us, steady, when they were read; 0 if never
  DriveState state;
  std::int64_t state_time = 0;      ///< us, steady, when it was read; 0 if never
  std::uint32_t encoder_lines = 0;  ///< 0 if the drive does not report them
};

/// Decides what to read when. Each poll reads one block: faults, positions and speeds. A drive that does not have that
/// block (exception 02) is asked for less: positions and speeds, then positions alone. The speeds are not used for
/// WHEELS. Every tenth poll also reads the status, and the faults if the block lacks them.
///
/// On a serial line a reply does not name its request, and a late reply looks like the next one. So after an error the
/// next request is for three registers, which no other reply has. When it is answered, positions are read again. Has no
/// thread of its own and does not sleep; libmodbus waits in `read`.
///
/// Counts: modbus.replies, modbus.fallbacks, refused.timeout, .slow, .crc, .wrong_slave, .malformed, .unasked,
/// .illegal_function, .illegal_address, .illegal_value, .device_failure, .exception (any other).
class DrivePoll {
 public:
  using Read = std::function<Reply(const Block&, std::span<std::uint16_t>)>;
  /// Called between two requests: a serial line must be silent for 3.5 characters.
  using Gap = std::function<void()>;

  /// Consecutive polls without positions after which the port is to be reopened.
  static constexpr int kMaxFailures = 5;
  static constexpr int kStatusEvery = 10;  // polls

  DrivePoll(Read read, Gap gap) : read_(std::move(read)), gap_(std::move(gap)) {}

  /// Polls once. Calls `on_reading` as soon as positions are available.
  void poll(const std::function<void(const Reading&)>& on_reading);
  /// The port was opened: the state of the drive is unknown.
  void restart();
  /// The port has vanished, or nothing useful was received for so long that it should be reopened.
  [[nodiscard]] bool must_reopen() const { return gone_ || failures_ >= kMaxFailures; }

  /// The port has vanished, or the other end has closed the connection.
  [[nodiscard]] bool is_gone() const { return gone_; }

  /// Fault of the communication in words; empty if there is none.
  [[nodiscard]] const std::string& fault() const { return fault_; }
  [[nodiscard]] const RefusalShare& share() const { return share_; }
  /// Call it before each poll, and also while no poll is possible. `now`: us, steady clock.
  void tick(std::int64_t now);
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  [[nodiscard]] bool read(const Block& block, std::span<std::uint16_t> registers);
  void refuse(const Reply& reply);
  void read_status(const Block& block);
  void read_faults();
  void read_encoder_lines();
  bool read_block(const std::function<void(const Reading&)>& on_reading);

  Read read_;
  Gap gap_;
  std::size_t level_ = 0;  // number of blocks that the drive does not have
  int polls_ = 0;
  int failures_ = 0;  // in a row
  bool gone_ = false;
  bool in_step_ = false;  // no reply to an earlier request can arrive
  bool asked_lines_ = false;
  Reply last_;
  Reading reading_;
  std::string fault_;
  std::int64_t now_ = 0;  // us, of the latest tick
  RefusalShare share_;
  Counters counters_;
};

}  // namespace curbstone::encoder::modbus
