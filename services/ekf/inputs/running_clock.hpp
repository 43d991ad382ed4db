#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/bus/counters.hpp"

namespace curbstone::ekf::inputs {

/// Takes steps of the host's clock out of the stamps. A filter that saw a step would predict over it, or mix samples
/// from before the step with samples from after it. The output stamps run on as the sensors do.
///
/// A sample whose sequence number continues the last one's and whose stamp goes back by more than kMinLeap comes from a
/// clock that was set. The step is accepted after kConfirmations samples in a row that agree; until then the samples
/// are dropped. A step forward may also come from a sensor that was silent and whose driver continues its sequence
/// numbers. So there both sensors must leap, by the same amount and at the same time, and the wheels must not have
/// turned on meanwhile; IMU samples after a leap wait kPatience for the wheels' leap.
///
/// The output stays on the clock that both sensors share: if that of one alone is set, the other one's goes on.
///
/// A function of the two channels' sequences. Pure; one thread; us.
class RunningClock {
 public:
  enum class Sensor { kImu, kWheels };
  static constexpr std::int64_t kMinLeap = 100'000;
  static constexpr int kConfirmations = 3;
  static constexpr std::int64_t kPatience = 100'000;
  static constexpr int kSilent = 100;  ///< samples of one sensor, after which the other one does not count

  /// Returns the sample's stamp without steps; nothing if the sample is to be dropped. `angles`: rad, of both wheels,
  /// in their samples.
  [[nodiscard]] std::optional<std::int64_t> add(Sensor sensor, std::int64_t utime, std::int32_t sequence,
                                                const std::array<double, 2>& angles = {});
  /// Offset to add to an output stamp to get a stamp of the host's present clock.
  [[nodiscard]] std::int64_t offset() const { return offset_; }
  /// Counters: clock_set.*, dropped.clock_set.*
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  struct Channel {
    const char* name;
    std::optional<std::int64_t> last = {};  // as received
    std::int32_t sequence = 0;
    std::int64_t period = 0;
    std::int64_t offset = 0;
    std::int64_t leap = 0, leapt_to = 0;                  // forward, between consecutive samples
    std::optional<std::int64_t> before_leap = {};         // `last` before it, until the next sample
    std::optional<std::int64_t> first = {}, newest = {};  // of the samples that may have a new clock
    int agreeing = 0;
    int alone = 0;  // samples since the other sensor's last

    [[nodiscard]] bool is_next(std::int32_t number) const;
    /// Remembers the number, unless its message is out of order.
    void note_number(std::int32_t number);
    /// Forgets a leap after which this stamp continues the ones before it: one stamp alone was wild.
    void forget_wild_leap(std::int64_t utime, bool consecutive);
    /// Whether the clock may have been set between two consecutive samples that are `step` apart.
    [[nodiscard]] bool may_be_set(std::int64_t step) const;
    /// Whether the sample goes on from those that may have a new clock.
    [[nodiscard]] bool continues_new_clock(std::int64_t utime, std::int64_t step) const;
  };
  [[nodiscard]] std::optional<std::int64_t> take(Sensor sensor, std::int64_t utime, std::int32_t sequence,
                                                 double turned);
  [[nodiscard]] static bool have_both_leapt(const Channel& own, const Channel& other, std::int64_t leap);
  /// Whether this leap brings the sensors' clocks together again.
  [[nodiscard]] static bool ends_difference(const Channel& own, const Channel& other, std::int64_t leap);
  [[nodiscard]] std::optional<std::int64_t> check_step(Channel& own, Channel& other, std::int64_t utime,
                                                       bool continues);
  [[nodiscard]] Channel& channel(Sensor sensor) { return channels_[sensor == Sensor::kImu ? 0 : 1]; }
  [[nodiscard]] Channel& counterpart(Sensor sensor) { return channels_[sensor == Sensor::kImu ? 1 : 0]; }

  static constexpr std::int64_t kSame = 50'000;  // us, tolerance between the steps of two sensors
  std::array<Channel, 2> channels_{Channel{.name = "imu"}, Channel{.name = "wheels"}};
  std::int64_t offset_ = 0;
  std::array<double, 2> angles_ = {};  // rad, of the wheels' last sample
  double turn_ = 0.0;                  // rad, the most between two samples, lately
  Counters counters_;
};

}  // namespace curbstone::ekf::inputs
