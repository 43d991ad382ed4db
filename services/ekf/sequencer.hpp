#pragma once

#include <algorithm>
#include <deque>
#include <limits>
#include <optional>
#include <variant>

#include "common/counters.hpp"
#include "services/ekf/ekf_config.hpp"
#include "services/ekf/samples.hpp"
#include "services/ekf/stamp_guard.hpp"

namespace curbstone {

/// Merges the two sensors' samples into the order of their stamps. A sample is let through as soon as the other sensor
/// has been heard with the same or a later stamp: nothing earlier can come. If the other sensor keeps silent, it goes
/// when its own channel is `timing.hold` ahead. So the order that comes out is a function of the two sequences, however
/// they interleave on the bus, as long as neither lags the other by more than the hold. At equal stamps wheels go
/// first.
///
/// Not taken, and counted: duplicates, stamps that go back, stray stamps, samples that come after their turn.
class Sequencer {
 public:
  using Sample = std::variant<ImuSample, WheelSample>;

  explicit Sequencer(const TimingConfig& config);

  void push(const ImuSample& sample);
  void push(const WheelSample& sample);
  /// The next sample whose turn it is; with `drain` without waiting for what may never come.
  [[nodiscard]] std::optional<Sample> pop(bool drain = false);

  /// Newest accepted stamp of either sensor, us; the smallest number if none.
  [[nodiscard]] std::int64_t newest() const { return std::max(imu_.newest, wheels_.newest); }
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::min();
  template <class T>
  struct Channel {
    Channel(const char* channel_name, std::int64_t max_jump) : name(channel_name), guard(max_jump) {}
    const char* name;
    StampGuard guard;
    std::deque<T> queue;
    std::int64_t newest = kNever;  // us
  };

  template <class T, class Other>
  void take(Channel<T>& own, Channel<Other>& other, const T& sample);
  template <class T, class Other>
  void turn_clock_back(Channel<T>& own, Channel<Other>& other);
  template <class T, class Other>
  [[nodiscard]] std::optional<Sample> pop_front(Channel<T>& own, const Channel<Other>& other, bool drain);

  std::int64_t hold_;  // us
  Channel<ImuSample> imu_;
  Channel<WheelSample> wheels_;
  std::int64_t processed_ = kNever;  // us, stamp of the last sample let through
  Counters counters_;
};

}  // namespace curbstone
