#pragma once

#include <algorithm>
#include <deque>
#include <limits>
#include <optional>
#include <variant>

#include "common/bus/counters.hpp"
#include "services/ekf/base/ekf_config.hpp"
#include "services/ekf/base/samples.hpp"
#include "services/ekf/inputs/map_increment.hpp"
#include "services/ekf/inputs/stamp_guard.hpp"

namespace curbstone::ekf::inputs {

/// Merges the sensors' samples into the order of their stamps. A sample is released as soon as the other sensor has
/// been heard with the same or a later stamp: nothing earlier can come. If the other sensor is silent, the sample is
/// released when its own channel is `timing.hold` ahead. So the output order is a function of the sequences, however
/// they interleave on the bus, as long as neither lags the other by more than the hold. At equal stamps wheels go
/// first.
///
/// An output sample may be older than the one before, by at most `timing.history` (RewindingFilter applies it at its
/// own time). Its place in the order depends on the sequences only, too:
/// - A sample that is behind its own channel follows that channel's newest.
/// - A map increment follows when the sensors are `map.delay` past its end: the mapper needs that long in live
///   operation, and a replay must not have it sooner.
/// - A sample that lags the other sensor by more than the hold follows at once.
///
/// Dropped and counted: duplicates, stray stamps, and samples older than the history.
class Sequencer {
 public:
  using Sample = std::variant<base::WheelSample, base::ImuSample, MapIncrement>;

  explicit Sequencer(const base::EkfConfig& config);

  void push(const base::ImuSample& sample);
  void push(const base::WheelSample& sample);
  void push(const MapIncrement& increment);
  /// Drops waiting wheel samples with later stamps: they belong to another clock.
  void drop_wheels_after(std::int64_t utime);
  /// Returns the next sample, if it is due.
  [[nodiscard]] std::optional<Sample> pop();
  /// Returns the next sample without waiting for the other sensor: the drive is over.
  [[nodiscard]] std::optional<Sample> pop_rest();

  /// Newest accepted stamp of either sensor, us; the smallest number if there is none.
  [[nodiscard]] std::int64_t newest() const { return std::max(imu_.newest, wheels_.newest); }
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::min();
  template <class T>
  struct Scheduled {
    std::int64_t utime;  // us, time at which the sample is due
    T sample;
  };
  template <class T>
  struct Channel {
    Channel(const char* channel_name, std::int64_t max_jump) : name(channel_name), guard(max_jump) {}
    const char* name;
    StampGuard guard;
    std::deque<Scheduled<T>> queue;  // by due time
    std::int64_t newest = kNever;    // us
  };

  template <class T, class Other>
  void take(Channel<T>& own, Channel<Other>& other, const T& sample);
  template <class T, class Other>
  void on_clock_set_back(Channel<T>& own, Channel<Other>& other);
  [[nodiscard]] bool empty() const { return imu_.queue.empty() && wheels_.queue.empty(); }
  /// Which channel has the next sample. Not if empty().
  [[nodiscard]] bool are_wheels_next() const;
  template <class T, class Other>
  [[nodiscard]] bool is_due(const Channel<T>& own, const Channel<Other>& other) const;
  template <class T>
  [[nodiscard]] Sample pop_front(Channel<T>& own);

  std::int64_t hold_;     // us
  std::int64_t history_;  // us
  std::int64_t delay_;    // us, of map increments
  Channel<base::ImuSample> imu_;
  Channel<base::WheelSample> wheels_;
  std::deque<Scheduled<MapIncrement>> increments_;
  std::int64_t processed_ = kNever;  // us, due time of the latest released sample
  Counters counters_;
};

}  // namespace curbstone::ekf::inputs
