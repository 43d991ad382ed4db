#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/bus/counters.hpp"

namespace curbstone::encoder {

/// Turns the drive's raw int32 counts into angles (rad) and speeds (rad/s), positive forward for either wheel. Index 0
/// is the left wheel, 1 the right. Raw counts may wrap. Pure; one thread.
///
/// Counts: refused.jump (more than the wheels can turn, or back to zero at once; one corrupted frame),
/// refused.old_counts (one has not changed, and from so fast it cannot have stopped; the distance is in the next
/// sample), counts_restarted (a jump that stays: the drive counts anew; the distance meanwhile is lost).
class WheelCounter {
 public:
  using Raw = std::array<std::int32_t, 2>;
  struct Settings {
    double counts_per_revolution = 4096;
    std::array<bool, 2> inverted = {false, true};
    double max_speed = 150;  ///< rad/s, of a wheel
  };
  struct Sample {
    std::array<std::int64_t, 2> counts{};  ///< since the first sample
    std::array<double, 2> angle{};         ///< rad since the first sample
    std::array<double, 2> speed{};         ///< rad/s, since the sample before
  };

  explicit WheelCounter(const Settings& settings) : settings_(settings) {}

  /// `elapsed` s since the last update() call. Empty if the counts cannot be.
  std::optional<Sample> update(const Raw& raw, double elapsed);
  /// The counter of the last update() that was empty.
  [[nodiscard]] const char* refusal() const { return refusal_; }
  /// The drive's counts begin anew with the next sample.
  void restart() { last_.reset(); }

  /// `elapsed` s passed since the last update() or pass() call, and nothing is known of the counts.
  void pass(double elapsed) { since_accepted_ += elapsed; }

  /// How many periods of `period` s (least..most) have passed since the last update() or pass() call, if the wheels did
  /// not accelerate more than vehicles do. Nothing where the counts do not tell, as with slow wheels.
  [[nodiscard]] std::optional<int> likely_periods(const Raw& raw, int least, int most, double period) const;

  /// Whether the wheels can have turned so far within `elapsed` s since the last update() or pass() call.
  [[nodiscard]] bool can_be(const Raw& raw, double elapsed) const;

  /// The wheels turned so fast that they cannot have stopped within `period` s.
  [[nodiscard]] bool turns_fast(double period) const;

  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  [[nodiscard]] static std::array<double, 2> difference(const Raw& from, const Raw& to);
  [[nodiscard]] bool possible(const std::array<double, 2>& moved, double time) const;
  /// How far wheels can turn more than by their rate, counts.
  [[nodiscard]] double accelerated(double time) const;
  /// By the rate, and by no more acceleration than vehicles have.
  [[nodiscard]] bool explained(std::size_t wheel, double moved, double time) const;
  [[nodiscard]] bool begins_at_zero(const Raw& raw, const std::array<double, 2>& moved) const;
  [[nodiscard]] bool is_old(const std::array<double, 2>& moved) const;
  [[nodiscard]] Sample sample(const std::array<double, 2>& moved, double elapsed) const;

  Settings settings_;
  std::optional<Raw> last_;              // raw counts of the last accepted sample
  std::array<std::int64_t, 2> total_{};  // counts, signed forward
  std::array<double, 2> rate_{};         // raw counts/s, over the last sample
  double rate_time_ = 0;                 // s, that this took
  double since_accepted_ = 0;            // s
  std::optional<Raw> suspect_;           // the last sample that was refused
  int suspects_ = 0;
  const char* refusal_ = "refused.jump";
  Counters counters_;
};

}  // namespace curbstone::encoder
