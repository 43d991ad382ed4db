#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/bus/counters.hpp"
#include "drivers/encoder/lone_leap.hpp"

namespace curbstone::encoder {

/// Converts the drive's raw int32 counts to angles (rad) and speeds (rad/s), positive forward for both wheels. Index 0
/// is the left wheel, 1 the right. Raw counts may wrap. Pure; one thread.
///
/// Counts: refused.jump (more than the wheels can turn, or a sudden zero; one corrupted frame), refused.old_counts (a
/// count has not changed, though the wheel was too fast to have stopped; the distance is in the next sample),
/// refused.outlier (a count that leaps away from those before it, and that the next one does not confirm; also the
/// first ones, until two steps agree), counts_restarted (a jump that persists: the drive has restarted its counts; the
/// distance in the meantime is lost).
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
    std::array<double, 2> speed{};         ///< rad/s, since the previous sample
  };

  /// Counts per period: to stop at once from there takes 20 m/s^2 at 4096 counts, 0.17 m and 100 Hz.
  static constexpr double kTooFast = 8;
  static constexpr double kBraking = 60;     ///< rad/s^2, of a wheel: 10 m/s^2 at 0.17 m
  static constexpr int kMaxUnconfirmed = 5;  ///< first samples that do not agree; the next is believed

  explicit WheelCounter(const Settings& settings) : settings_(settings) {}

  /// `elapsed` s since the last update() call. Empty if the counts are impossible.
  std::optional<Sample> update(const Raw& raw, double elapsed);
  /// Name of the counter for the last update() that returned nothing.
  [[nodiscard]] const char* refusal() const { return refusal_; }
  /// The drive's counts restart with the next sample.
  void restart() { last_.reset(); }
  /// The drive says that it has booted: its counts restart with the next sample if that is near zero. A drive that
  /// keeps its counts goes on, and so does one that has not booted: a damaged digit in a heartbeat says so too.
  void restart_near_zero() { has_booted_ = true; }

  /// `elapsed` s have passed since the last update() or pass() call without known counts.
  void skip(double elapsed);

  /// Number of periods of `period` s (least..most) since the last update() or pass() call, assuming that the wheels did
  /// not accelerate more than vehicles do. Nothing if the counts do not show it, as with slow wheels.
  [[nodiscard]] std::optional<int> likely_periods(const Raw& raw, int least, int most, double period) const;

  /// Counts between two readings, of the wheel that turned more; correct across a wrap.
  [[nodiscard]] static double step(const Raw& from, const Raw& to);

  /// Whether the wheels can have turned that far within `elapsed` s since the last update() or pass() call.
  [[nodiscard]] bool is_possible(const Raw& raw, double elapsed) const;

  /// Most counts that a wheel can turn within `elapsed` s from its present speed.
  [[nodiscard]] double most_turned(double elapsed) const;

  /// Whether the wheels turned too fast to stop within `period` s.
  [[nodiscard]] bool turns_fast(double period) const;

  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  void begin_at(const Raw& raw);
  [[nodiscard]] Sample accept(const Raw& raw, const std::array<double, 2>& moved);
  [[nodiscard]] std::nullopt_t refuse(const char* cause);
  [[nodiscard]] bool is_lasting_jump(const Raw& raw, double elapsed);
  [[nodiscard]] static std::array<double, 2> difference(const Raw& from, const Raw& to);
  [[nodiscard]] bool possible(const std::array<double, 2>& moved, double time) const;
  /// counts, maximum turn beyond that at a constant rate.
  [[nodiscard]] double accelerated(double time) const;
  /// Whether the rate and a realistic acceleration explain the turn.
  [[nodiscard]] bool explained(std::size_t wheel, double moved, double time) const;
  [[nodiscard]] bool counts_were_reset(const Raw& raw, const std::array<double, 2>& moved) const;
  [[nodiscard]] bool is_near_zero(const Raw& raw, double time) const;
  [[nodiscard]] bool is_stale(const std::array<double, 2>& moved) const;
  [[nodiscard]] bool is_outlier(const std::array<double, 2>& moved);
  [[nodiscard]] bool is_unconfirmed_start(const Raw& raw, const std::array<double, 2>& moved);
  /// counts, of a prediction for `time` s from a rate over `rate_time` s.
  [[nodiscard]] double tolerance(double time, double rate_time) const;
  [[nodiscard]] Sample sample(const std::array<double, 2>& moved, double elapsed) const;

  Settings settings_;
  std::optional<Raw> last_;              // raw counts of the latest accepted sample
  std::array<std::int64_t, 2> total_{};  // counts, signed forward
  std::array<double, 2> rate_{};         // raw counts/s, over the latest interval
  double rate_time_ = 0;                 // s, duration of that interval
  double since_accepted_ = 0;            // s
  std::optional<Raw> suspect_;           // the latest refused sample
  int suspects_ = 0;
  struct Second {  // the counts after the first ones, while no step confirms the first step
    Raw raw;
    std::array<double, 2> moved;
    double time;       // s, of that step
    double since = 0;  // s
  };
  std::optional<Second> second_;
  bool has_booted_ = false;
  int unconfirmed_ = 0;
  double unknown_ = 0;  // s, from the first sample to the first of the confirmed ones
  LoneLeap leap_;
  const char* refusal_ = "refused.jump";
  Counters counters_;
};

}  // namespace curbstone::encoder
