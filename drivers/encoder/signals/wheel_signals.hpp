#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "common/bus/counters.hpp"
#include "drivers/encoder/can/can_frame.hpp"
#include "drivers/encoder/signals/can_signal.hpp"

namespace curbstone::encoder::signals {

/// Reads the signals of both wheels, in one frame or in two. Index 0 is the left wheel. Pure; one thread.
///
/// Two frames are paired in one order only: the leading frame is the one after the longer pause, which is learnt from
/// the last kLearn pauses. If they were paired in any order, then after a loss the left wheel of one sample would be
/// paired with the right wheel of the next, and stay so.
///
/// Counts: refused.length (frames too short for the signal), ignored.frames (other ids), lost.halves (one wheel's value
/// without the other's).
class WheelSignals {
 public:
  struct Values {
    std::array<std::int32_t, 2> counts{};  ///< raw, unwrapped by the signal's width; wrap as int32
    std::array<double, 2> values{};        ///< raw * factor + offset
  };

  WheelSignals(const CanSignal& left, const CanSignal& right) : signals_{left, right} {}

  /// Returns both values with the frame that completes them. `time` of receipt, us.
  std::optional<Values> on_frame(std::int64_t time, const can::CanFrame& frame);

  /// That of the narrower counter, see CanSignal.
  [[nodiscard]] double half_range() const { return std::min(signals_[0].half_range(), signals_[1].half_range()); }
  /// The least difference of two values, of the coarser signal.
  [[nodiscard]] double resolution() const {
    return std::max(std::abs(signals_[0].factor), std::abs(signals_[1].factor));
  }
  /// The ids that a source must pass on; bit 31 marks a 29-bit id.
  [[nodiscard]] std::vector<std::uint32_t> ids() const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  /// Mean pause between the other wheel's frame and this wheel's.
  struct Pause {
    double mean = 0;  // us
    int count = 0;    // at most kLearn
  };
  static constexpr int kLearn = 16;
  static constexpr double kClearly = 2;   // times as long
  static constexpr double kAtOnce = 3;    // likewise, while little has been learnt
  static constexpr double kMaxPause = 2;  // cycles, maximum length of a pause
  static constexpr double kApart = 0.9;   // cycles later than usual: beyond it the halves are not of one sample

  void learn(std::size_t wheel, std::int64_t time);
  [[nodiscard]] bool knows_cycle() const { return std::min(pauses_[0].count, pauses_[1].count) >= kLearn / 2; }
  /// us, between pairs.
  [[nodiscard]] double cycle() const { return pauses_[0].mean + pauses_[1].mean; }
  [[nodiscard]] bool completes(std::size_t wheel);
  void take(std::size_t wheel, std::int64_t raw);

  std::array<CanSignal, 2> signals_;
  std::array<std::optional<std::int64_t>, 2> last_;  // raw
  std::optional<std::size_t> leads_;                 // the wheel whose frame is the first of a pair
  std::optional<std::size_t> newest_;                // the wheel whose frame was received last
  std::int64_t newest_time_ = 0;                     // us, of its receipt
  double pause_ = 0;                                 // us, between it and the previous frame
  std::array<Pause, 2> pauses_;
  bool waits_ = false;  // the leading frame has been received, the other one not yet
  std::array<std::int64_t, 2> unwrapped_{};
  Counters counters_;
};

}  // namespace curbstone::encoder::signals
