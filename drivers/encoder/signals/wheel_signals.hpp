#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "common/bus/counters.hpp"
#include "drivers/encoder/can/can_frame.hpp"
#include "drivers/encoder/signals/can_signal.hpp"

namespace curbstone::encoder::signals {

/// The signals of both wheels, in one frame or in two. Index 0 is the left wheel. Pure; one thread.
///
/// Counts: refused.length (frames too short for the signal), ignored.frames (of others), lost.halves (a wheel's value
/// came again before the other's).
class WheelSignals {
 public:
  struct Values {
    std::array<std::int32_t, 2> counts{};  ///< raw, unwrapped by the signal's width; they wrap as int32
    std::array<double, 2> values{};        ///< raw * factor + offset
  };

  WheelSignals(const CanSignal& left, const CanSignal& right) : signals_{left, right} {}

  /// Both values, with the frame that brings the second of them.
  std::optional<Values> on_frame(const can::CanFrame& frame);

  /// The ids that a source must let through; bit 31 marks one of 29 bits.
  [[nodiscard]] std::vector<std::uint32_t> ids() const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  void take(std::size_t wheel, std::int64_t raw);

  std::array<CanSignal, 2> signals_;
  std::array<std::optional<std::int64_t>, 2> last_;  // raw
  std::array<bool, 2> fresh_{};
  std::array<std::int64_t, 2> unwrapped_{};
  Counters counters_;
};

}  // namespace curbstone::encoder::signals
