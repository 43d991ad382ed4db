#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "common/bus/counters.hpp"

namespace curbstone::ekf::inputs {

/// Takes steps of the host's clock out of the stamps, so that the filter never hears of them: by half a second it would
/// predict, or mix what was measured before with what was measured after. What comes out runs on as the sensors do.
///
/// A sample whose sequence number continues the last one's and whose stamp goes back by more than kLeast came from a
/// clock that was set; kConfirmations in a row that agree are believed, and until then are not taken. Forward it may as
/// well come from a sensor that was silent, and whose driver goes on counting. So there both sensors must leap, by the
/// same and at the same time; what the IMU says after its leap waits kPatience for the wheels'. Steps of more than
/// `max_jump` are left to StampGuard.
///
/// A function of the two channels' sequences. Pure; one thread; us.
class RunningClock {
 public:
  enum class Sensor { kImu, kWheels };
  static constexpr std::int64_t kLeast = 100'000;
  static constexpr int kConfirmations = 3;
  static constexpr std::int64_t kPatience = 100'000;

  explicit RunningClock(std::int64_t max_jump) : max_jump_(max_jump) {}

  /// The sample's stamp without steps; nothing if it is not to be taken.
  [[nodiscard]] std::optional<std::int64_t> add(Sensor sensor, std::int64_t utime, std::int32_t sequence);
  /// What is to be added to a stamp that came out, for the host's clock as it is set now.
  [[nodiscard]] std::int64_t set_by() const { return set_by_; }
  /// clock_set.*, dropped.clock_set.*
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  struct Channel {
    const char* name;
    std::optional<std::int64_t> last = {};  // as it came
    std::int32_t sequence = 0;
    std::int64_t period = 0;
    std::int64_t set_by = 0;
    std::int64_t leap = 0, leapt_to = 0;                  // forward, between samples whose numbers follow each other
    std::optional<std::int64_t> first = {}, newest = {};  // of those that may have a new clock
    int agreeing = 0;
  };
  [[nodiscard]] static bool have_both_leapt(const Channel& own, const Channel& other, std::int64_t leap);
  std::optional<std::int64_t> doubt(Channel& own, Channel& other, std::int64_t utime, bool goes_on);

  static constexpr std::int64_t kSame = 50'000;  // us between what two sensors tell of one step
  std::int64_t max_jump_;
  std::array<Channel, 2> channels_{Channel{.name = "imu"}, Channel{.name = "wheels"}};
  std::int64_t set_by_ = 0;
  Counters counters_;
};

}  // namespace curbstone::ekf::inputs
