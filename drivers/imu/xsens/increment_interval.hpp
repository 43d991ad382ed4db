#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace curbstone::imu::xsens {

/// Over how many sample intervals an increment is integrated: each output of an MTi has a rate of its own, and an
/// increment is that of its own interval. It is the median step of the times of the messages that have it, so neither a
/// lost message nor a wrong time counts. Pure; one thread.
class IncrementInterval {
 public:
  /// A message with SampleTime `ticks` of 0.1 ms has the increment.
  void seen(std::uint32_t ticks) {
    if (last_ && ticks > *last_ && ticks - *last_ <= kMaxInterval) steps_[count_++ % kSteps] = ticks - *last_;
    last_ = ticks;
  }
  /// Sample intervals of `interval` us: n, or 1/n if the increment comes more often than samples. Empty if it is not
  /// known yet.
  [[nodiscard]] std::optional<double> samples(double interval) const {
    if (count_ < kMinSteps || interval <= 0) return {};
    auto sorted = steps_;
    const std::size_t n = std::min(count_, kSteps);
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(n / 2);
    std::nth_element(sorted.begin(), middle, sorted.begin() + static_cast<std::ptrdiff_t>(n));
    const double ratio = 100.0 * *middle / interval;
    return ratio >= 1 ? std::round(ratio) : 1 / std::round(1 / ratio);
  }
  void restart() { *this = {}; }

 private:
  static constexpr std::uint32_t kMaxInterval = 10'000;  // ticks, a second
  static constexpr std::size_t kSteps = 15;
  static constexpr std::size_t kMinSteps = 3;

  std::optional<std::uint32_t> last_;
  std::array<std::uint32_t, kSteps> steps_{};  // ticks
  std::size_t count_ = 0;
};

}  // namespace curbstone::imu::xsens
