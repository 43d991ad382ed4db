#pragma once

#include <algorithm>
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
/// Two frames are a pair in one order only: the one that leads comes after the longer pause, which is learnt from the
/// last kLearn pauses. In whatever order they came, after a loss the left wheel of one sample would be with the right
/// one of the next, and remain so.
///
/// Counts: refused.length (frames too short for the signal), ignored.frames (of others), lost.halves (a wheel's value
/// came without the other's).
class WheelSignals {
 public:
  struct Values {
    std::array<std::int32_t, 2> counts{};  ///< raw, unwrapped by the signal's width; they wrap as int32
    std::array<double, 2> values{};        ///< raw * factor + offset
  };

  WheelSignals(const CanSignal& left, const CanSignal& right) : signals_{left, right} {}

  /// Both values, with the frame that brings the second of them. `time` of receipt, us.
  std::optional<Values> on_frame(std::int64_t time, const can::CanFrame& frame);

  /// The ids that a source must let through; bit 31 marks one of 29 bits.
  [[nodiscard]] std::vector<std::uint32_t> ids() const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  /// The mean pause before a wheel's frame, since the other wheel's.
  struct Pause {
    double mean = 0;  // us
    int count = 0;    // kLearn at most
  };
  static constexpr int kLearn = 16;
  static constexpr double kClearly = 2;  // times longer
  static constexpr double kAtOnce = 3;   // likewise, while little is learnt
  static constexpr double kLongest = 2;  // cycles, of a pause
  static constexpr double kApart = 0.9;  // of a cycle, later than usual: the halves are not of one

  void learn(std::size_t wheel, std::int64_t time);
  [[nodiscard]] bool knows_cycle() const { return std::min(pauses_[0].count, pauses_[1].count) >= kLearn / 2; }
  /// us, from pair to pair.
  [[nodiscard]] double cycle() const { return pauses_[0].mean + pauses_[1].mean; }
  [[nodiscard]] bool completes(std::size_t wheel);
  void take(std::size_t wheel, std::int64_t raw);

  std::array<CanSignal, 2> signals_;
  std::array<std::optional<std::int64_t>, 2> last_;  // raw
  std::optional<std::size_t> leads_;                 // whose frame is the first of a pair
  std::optional<std::size_t> newest_;                // whose frame came last
  std::int64_t newest_time_ = 0;                     // us, of its receipt
  double pause_ = 0;                                 // us, since the frame before it
  std::array<Pause, 2> pauses_;
  bool waits_ = false;  // the one that leads has come, the other not yet
  std::array<std::int64_t, 2> unwrapped_{};
  Counters counters_;
};

}  // namespace curbstone::encoder::signals
