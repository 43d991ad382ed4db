#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

namespace curbstone::imu {

/// Estimates when samples were taken of which only the time of receipt is known. A read of the port may return several
/// at once: the last one was taken just now, each earlier one a period before. The period is the mean over the last
/// kBlock samples by their receipt; until then, the requested one.
///
/// No stamp is before one that was published: if the period would put it there, the samples are spread evenly between
/// the published stamp and the last sample. Times in us. Pure; one thread.
class ReceiptStamps {
 public:
  static constexpr std::int64_t kBlock = 100;
  static constexpr std::int64_t kPause = 1'000'000;  ///< us without a sample after which the mean restarts

  /// `rate`: Hz.
  explicit ReceiptStamps(int rate) : period_(1'000'000 / std::max(rate, 1)) {}

  /// Converts, in place, the times of receipt of the samples of a read at `now`, in their order, to stamps.
  /// `published`: the latest published stamp; 0: none. If the host's clock was set back to before it, the times are not
  /// changed.
  void spread(std::int64_t now, std::int64_t published, std::span<std::int64_t> times) {
    if (times.empty()) return;
    const auto count = static_cast<std::int64_t>(times.size());
    learn(times.back(), count);
    const std::int64_t end = times.back() > published ? times.back() : std::min(published + period_, now);
    if (end <= published) return;
    const std::int64_t step = published > 0 ? std::min(period_, (end - published) / count) : period_;
    for (std::int64_t i = 0; i < count; ++i) times[static_cast<std::size_t>(i)] = end - (count - 1 - i) * step;
  }
  [[nodiscard]] std::int64_t period() const { return period_; }

 private:
  void learn(std::int64_t received, std::int64_t count) {
    const bool anew = begin_ == 0 || received < last_ || received - last_ > kPause;
    last_ = received;
    counted_ = anew ? 0 : counted_ + count;
    if (anew) begin_ = received;
    if (counted_ < kBlock || received <= begin_) return;
    period_ = std::max<std::int64_t>((received - begin_) / counted_, 1);
    begin_ = received;
    counted_ = 0;
  }

  std::int64_t period_;       // us
  std::int64_t begin_ = 0;    // us, begin of the block
  std::int64_t last_ = 0;     // us
  std::int64_t counted_ = 0;  // samples since begin_
};

}  // namespace curbstone::imu
