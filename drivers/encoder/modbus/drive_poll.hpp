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

/// Both wheels at one instant, and what is known of the drive by then. Index 0 is the left wheel.
struct Reading {
  std::int64_t utime = 0;       ///< us since the Unix epoch, middle between request and reply
  std::int64_t round_trip = 0;  ///< us; the counts were taken at some time of it: the stamp is right to half of it
  std::array<std::int32_t, 2> counts{};
  std::optional<std::array<std::int16_t, 2>> speeds = std::nullopt;  ///< 0.1 rpm, read with the counts
  std::array<std::uint16_t, 2> faults{};                             ///< bits, as 603F of the CAN drive
  std::int64_t faults_utime = 0;                                     ///< us, when they were read; 0 if never
  DriveState state;
  std::int64_t state_utime = 0;     ///< us, when it was read; 0 if never
  std::uint32_t encoder_lines = 0;  ///< 0 if the drive did not say
};

/// What is read when. Each poll reads one block: faults, positions and speeds. A drive that knows no such block
/// (exception 02) is asked for less: positions and speeds, then positions alone. The speeds are not used. Each tenth
/// poll also reads the status, and the faults where the block lacks them.
///
/// On a serial line a reply does not say what it answers, and one that comes late looks like the next one. So after an
/// error the next request is for three registers: no other reply is as long. Positions are read again when it is
/// answered. Has no thread of its own and does not sleep; libmodbus waits in `read`.
///
/// Counts: modbus.replies, modbus.fallbacks, refused.timeout, .slow, .crc, .wrong_slave, .malformed, .unasked,
/// .illegal_function, .illegal_address, .illegal_value, .device_failure, .exception (any other).
class DrivePoll {
 public:
  using Read = std::function<Reply(const Block&, std::span<std::uint16_t>)>;
  /// Called between two requests: a serial line must be silent for 3.5 characters.
  using Gap = std::function<void()>;

  /// Polls in a row without positions after which the port is to be opened anew.
  static constexpr int kMaxFailures = 5;
  static constexpr int kStatusEvery = 10;  // polls

  DrivePoll(Read read, Gap gap) : read_(std::move(read)), gap_(std::move(gap)) {}

  /// One poll. Calls `on_reading` as soon as positions are there.
  void poll(const std::function<void(const Reading&)>& on_reading);
  /// The port was opened: nothing is known of who is there.
  void restart();
  /// The port is no more, or nothing useful came for so long that it should be opened anew.
  [[nodiscard]] bool must_reopen() const { return gone_ || failures_ >= kMaxFailures; }

  /// What is wrong with the communication, in words; empty when nothing is.
  [[nodiscard]] const std::string& fault() const { return fault_; }
  [[nodiscard]] const RefusalShare& share() const { return share_; }
  /// To be called before each poll, and though no poll is possible. `now`: us, steady clock.
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
  std::size_t level_ = 0;  // of the blocks, how many the drive does not know
  int polls_ = 0;
  int failures_ = 0;  // in a row
  bool gone_ = false;
  bool in_step_ = false;  // no reply of an earlier request can come
  bool asked_lines_ = false;
  Reply last_;
  Reading reading_;
  std::string fault_;
  std::int64_t now_ = 0;  // us, of the last tick
  RefusalShare share_;
  Counters counters_;
};

}  // namespace curbstone::encoder::modbus
