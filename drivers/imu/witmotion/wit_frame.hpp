#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "common/bus/counters.hpp"

namespace curbstone::imu::witmotion {

/// Ids of the WitMotion standard protocol that are used.
enum class WitId : std::uint8_t {
  kTime = 0x50,
  kAcceleration = 0x51,
  kAngularRate = 0x52,
  kAngle = 0x53,
  kMagnetic = 0x54,
  kQuaternion = 0x59,
};

/// One frame with a valid sum: 0x55, id, four little-endian int16, sum. `data` is valid inside the handler only.
struct WitFrame {
  static constexpr std::size_t kSize = 11;  ///< bytes on the wire

  std::uint8_t id = 0;
  std::span<const std::uint8_t> data;  ///< 8 bytes
  bool after_gap = false;              ///< bytes were discarded between the previous frame and this one

  [[nodiscard]] std::int16_t word(std::size_t i) const;
};

[[nodiscard]] std::vector<std::uint8_t> encode_wit(std::uint8_t id, std::span<const std::uint8_t> data);

/// Splits a byte stream into frames. 0x55 is the header, an id and a common data byte, and the sum has only 8 bits. So
/// after any error the search continues from the next byte, and the first frame counts only if another one follows
/// immediately. Holds at most two frames. One thread. Source: WitMotion standard protocol.
///
/// Counts: frames, refused.checksum (where a frame was expected), garbage_bytes.
class WitParser {
 public:
  using Handler = std::function<void(const WitFrame&)>;

  /// The frames do not depend on how the stream is split into calls.
  void parse(std::span<const std::uint8_t> bytes, const Handler& handler);
  /// Drops a partly received frame: the link was interrupted.
  void reset();
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  enum class Candidate { kGood, kIncomplete, kBad };

  static Candidate examine(std::span<const std::uint8_t> bytes);
  void drain(const Handler& handler);

  std::vector<std::uint8_t> buffer_;
  bool in_step_ = false;  // the last frame was valid and no other bytes came since
  bool gap_ = false;
  Counters counters_;
};

}  // namespace curbstone::imu::witmotion
