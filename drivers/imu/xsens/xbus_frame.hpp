#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "common/bus/counters.hpp"

namespace curbstone::imu::xsens {

/// Message ids of the Xsens "Xbus" protocol that are used. An acknowledgement's id is that of the request plus one.
enum class Mid : std::uint8_t {
  kGotoMeasurement = 0x10,
  kGotoMeasurementAck = 0x11,
  kGotoConfig = 0x30,
  kGotoConfigAck = 0x31,
  kMtData2 = 0x36,
  kWakeUp = 0x3E,
  kWakeUpAck = 0x3F,
  kReset = 0x40,
  kResetAck = 0x41,
  kError = 0x42,
  kSetOutputConfiguration = 0xC0,
  kOutputConfiguration = 0xC1,
};

/// One message with a valid checksum. `data` points into the parser's buffer: valid inside the handler only.
struct XbusFrame {
  std::uint8_t mid = 0;
  std::span<const std::uint8_t> data;
  std::size_t wire_size = 0;  ///< bytes, preamble to checksum

  [[nodiscard]] bool is(Mid id) const { return mid == static_cast<std::uint8_t>(id); }
};

/// Encodes a message: preamble FA, bus id FF (master), id, length (extended if data exceeds 254 bytes), data, checksum.
/// Source: Xsens MT Low Level Communication Protocol (MT0101P).
[[nodiscard]] std::vector<std::uint8_t> encode_xbus(Mid mid, std::span<const std::uint8_t> data = {});

/// Splits a byte stream into frames. FA also occurs inside payloads, and garbage looks like headers, so a candidate
/// counts only if its checksum is right. If it is not, the search continues from the candidate's second byte, which
/// finds a good frame inside it. A truncated frame takes its missing bytes from the next frame, and one in 256 of these
/// has a valid checksum. So a candidate is refused if no preamble follows it, and a good frame or one with the same
/// header begins inside it. Holds at most kMaxFrame bytes. One thread.
///
/// Counts: frames, refused.checksum, refused.header (bus id, id or length that no device sends), refused.incomplete
/// (the rest of a candidate did not arrive within kPatience), refused.overlap, garbage_bytes.
class XbusParser {
 public:
  using Handler = std::function<void(const XbusFrame&)>;

  static constexpr std::size_t kMaxData = 2048;  ///< bytes; no output configuration makes more
  static constexpr std::size_t kMaxFrame = kMaxData + 7;
  static constexpr std::int64_t kPatience = 250'000;  ///< us; kMaxFrame takes 180 ms at 115200 baud

  /// `now`, us: when these bytes arrived. The frames do not depend on how the stream is split into calls, except for
  /// the overlaps above: they are found only if the other frame has arrived completely.
  void parse(std::int64_t now, std::span<const std::uint8_t> bytes, const Handler& handler);

  /// Drops a partly received frame: the link was interrupted.
  void reset() { buffer_.clear(); }
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  enum class Candidate { kComplete, kIncomplete, kRefused };

  void drain(std::int64_t now, const Handler& handler);
  Candidate examine(std::span<const std::uint8_t> bytes, XbusFrame& frame);
  static Candidate look_at(std::span<const std::uint8_t> bytes, XbusFrame& frame, const char** cause);
  static bool swallows_another(std::span<const std::uint8_t> bytes, std::size_t size);

  std::vector<std::uint8_t> buffer_;  // starts with the oldest candidate's preamble, if not empty
  std::int64_t waiting_since_ = 0;    // us, when the candidate at the front was first found incomplete
  bool waiting_ = false;
  Counters counters_;
};

}  // namespace curbstone::imu::xsens
