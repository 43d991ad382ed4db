#pragma once

#include <cstdint>
#include <cstdlib>
#include <optional>

#include "common/bytes/little_endian.hpp"
#include "drivers/encoder/can/can_frame.hpp"

namespace curbstone::encoder::canopen {

/// The latest positions and status of a drive, as it sent them. A digit of a CAN id may be damaged on a line without a
/// checksum: then one of these comes under the id of an EMCY, with counts for an error code. Pure; one thread.
class LatestPdos {
 public:
  static constexpr std::int64_t kNear = 4096;  ///< counts, more than a wheel turns between two frames

  void add_positions(const can::CanFrame& frame) { positions_ = frame; }
  void add_status(const can::CanFrame& frame) { status_ = frame; }

  /// Whether a frame of eight bytes of another id continues the positions, or repeats the status.
  [[nodiscard]] bool resembles(const can::CanFrame& frame) const {
    return (positions_ && near(frame, *positions_, 0) && near(frame, *positions_, 4)) ||
           (status_ && frame.data[0] == status_->data[0] && frame.data[2] == status_->data[2]);
  }

 private:
  static bool near(const can::CanFrame& a, const can::CanFrame& b, std::size_t at) {
    const auto difference = read_little_endian<std::uint32_t>(a.bytes().subspan(at)) -
                            read_little_endian<std::uint32_t>(b.bytes().subspan(at));
    return std::abs(std::int64_t{static_cast<std::int32_t>(difference)}) <= kNear;
  }

  std::optional<can::CanFrame> positions_, status_;
};

}  // namespace curbstone::encoder::canopen
