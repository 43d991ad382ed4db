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

/// Merges the sensors' samples into the order of their stamps. A sample is let through as soon as the other sensor has
/// been heard with the same or a later stamp: nothing earlier can come. If the other sensor keeps silent, it goes when
/// its own channel is `timing.hold` ahead. So the order that comes out is a function of the sequences, however they
/// interleave on the bus, as long as neither lags the other by more than the hold. At equal stamps wheels go first.
///
/// What comes out may be older than what came before, by at most `timing.history` (RewindingFilter takes it at its own
/// time); its turn is fixed by the sequences as well:
/// - a sample that is behind its own channel comes right after that channel's newest;
/// - a map increment comes when the sensors are `map.delay` past its end: the mapper needs that long, live, and a
/// replay
///   must not know it sooner;
/// - a sample that lags the other sensor by more than the hold comes at once.
///
/// Not taken, and counted: duplicates, stray stamps, and what is older than the history.
class Sequencer {
 public:
  using Sample = std::variant<base::WheelSample, base::ImuSample, MapIncrement>;

  explicit Sequencer(const base::EkfConfig& config);

  void push(const base::ImuSample& sample);
  void push(const base::WheelSample& sample);
  void push(const MapIncrement& increment);
  /// Wheel samples that wait with later stamps are of another clock: they go.
  void forget_wheels_after(std::int64_t utime);
  /// The next sample whose turn it is; with `drain` without waiting for what may never come.
  [[nodiscard]] std::optional<Sample> pop(bool drain = false);

  /// Newest accepted stamp of either sensor, us; the smallest number if none.
  [[nodiscard]] std::int64_t newest() const { return std::max(imu_.newest, wheels_.newest); }
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::min();
  template <class T>
  struct Turn {
    std::int64_t utime;  // us, at which the sample takes its turn
    T sample;
  };
  template <class T>
  struct Channel {
    Channel(const char* channel_name, std::int64_t max_jump) : name(channel_name), guard(max_jump) {}
    const char* name;
    StampGuard guard;
    std::deque<Turn<T>> queue;     // by turn
    std::int64_t newest = kNever;  // us
  };

  template <class T, class Other>
  void take(Channel<T>& own, Channel<Other>& other, const T& sample);
  template <class T, class Other>
  void turn_clock_back(Channel<T>& own, Channel<Other>& other);
  template <class T, class Other>
  [[nodiscard]] std::optional<Sample> pop_front(Channel<T>& own, const Channel<Other>& other, bool drain);

  std::int64_t hold_;     // us
  std::int64_t history_;  // us
  std::int64_t delay_;    // us, of the map
  Channel<base::ImuSample> imu_;
  Channel<base::WheelSample> wheels_;
  std::deque<Turn<MapIncrement>> increments_;
  std::int64_t processed_ = kNever;  // us, the last turn taken
  Counters counters_;
};

}  // namespace curbstone::ekf::inputs
