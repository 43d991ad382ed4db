#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "common/bus/counters.hpp"

namespace curbstone::imu::witmotion {

/// Ids of the WitMotion standard protocol that we use.
enum class WitId : std::uint8_t {
  kTime = 0x50,
  kAcceleration = 0x51,
  kAngularRate = 0x52,
  kAngle = 0x53,
  kMagnetic = 0x54,
  kQuaternion = 0x59,
};

/// One frame, its sum verified: 0x55, id, four little-endian int16, sum. `data` is valid inside the handler only.
struct WitFrame {
  static constexpr std::size_t kSize = 11;  ///< bytes on the wire

  std::uint8_t id = 0;
  std::span<const std::uint8_t> data;  ///< 8 bytes
  bool after_gap = false;              ///< bytes were thrown away between the frame before and this

  [[nodiscard]] std::int16_t word(std::size_t i) const;
};

[[nodiscard]] std::vector<std::uint8_t> encode_wit(std::uint8_t id, std::span<const std::uint8_t> data);

/// Cuts a byte stream into frames. 0x55 is the header, an id and a common byte of data, and the sum has 8 bits only. So
/// after anything wrong the search goes on from the next byte, and the first frame counts only if another follows it
/// at once. Holds at most two frames. One thread. Source: WitMotion standard protocol.
///
/// Counts: frames, refused.checksum (where a frame was due), garbage_bytes.
class WitParser {
 public:
  using Handler = std::function<void(const WitFrame&)>;

  /// Any cutting of the stream into calls gives the same frames.
  void parse(std::span<const std::uint8_t> bytes, const Handler& handler);
  /// Forgets a half-received frame: the link was interrupted.
  void reset();
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  enum class Candidate { kGood, kIncomplete, kBad };

  static Candidate examine(std::span<const std::uint8_t> bytes);
  void drain(const Handler& handler);

  std::vector<std::uint8_t> buffer_;
  bool in_step_ = false;  // the last frame was good and nothing else came since
  bool gap_ = false;
  Counters counters_;
};

}  // namespace curbstone::imu::witmotion
