#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace curbstone::imu::xsens {

/// Counts lost samples by the device's 16-bit packet counter. The device numbers all of its messages in one sequence:
/// samples, and others such as those of its GNSS receiver. So a number that is missing between two samples is a loss
/// only if no other message had it.
class PacketCounter {
 public:
  static constexpr int kMaxLate = 16;  ///< messages

  /// From the latest used sample to this one.
  struct Gap {
    int ahead = 1;   ///< messages; 1: the next one; negative, down to -kMaxLate: it is late
    int others = 0;  ///< of these, received messages that are not samples
    int lost = 0;    ///< messages that were not received
  };

  /// A message that is not a sample.
  void other(std::uint16_t counter) { others_.add(counter); }
  /// A sample that was received but is not used.
  void refused(std::uint16_t counter) { refused_.add(counter); }
  /// Empty before the first sample.
  [[nodiscard]] std::optional<Gap> gap(std::uint16_t counter) const {
    if (!last_) return {};
    const auto distance = static_cast<std::uint16_t>(counter - *last_);
    if (distance >= 65536 - kMaxLate) return Gap{distance - 65536, 0, 0};
    const int others = others_.between(*last_, distance), refused = refused_.between(*last_, distance);
    return Gap{distance, others, std::max(distance - 1 - others - refused, 0)};
  }
  /// The sample with this counter is used.
  void used(std::uint16_t counter) {
    note_lost(counter);
    last_ = counter;
    others_ = refused_ = {};
  }
  /// Whether a late message's counter was among the lost ones; removes it from them.
  bool found(std::uint16_t counter) {
    for (auto& lost : lost_) {
      if (lost == counter) {
        lost.reset();
        return true;
      }
    }
    return false;
  }
  /// The device has restarted its counter: any next counter is accepted.
  void restart() { *this = {}; }

 private:
  /// Counters received since the latest used sample; if there are more than it holds, the first ones.
  struct Came {
    std::array<std::uint16_t, 64> counters{};
    std::size_t size = 0;

    void add(std::uint16_t counter) {
      if (size < counters.size()) counters[size++] = counter;
    }
    [[nodiscard]] bool has(std::uint16_t counter) const {
      return std::ranges::count(std::span(counters).first(size), counter) > 0;
    }
    [[nodiscard]] int between(std::uint16_t last, std::uint16_t distance) const {
      const auto inside = [&](std::uint16_t c) {
        const auto d = static_cast<std::uint16_t>(c - last);
        return d > 0 && d < distance;
      };
      return static_cast<int>(std::ranges::count_if(std::span(counters).first(size), inside));
    }
  };

  /// Remembers the latest counters that are missing before this one.
  void note_lost(std::uint16_t counter) {
    if (!last_ || gap(counter)->lost == 0) return;
    for (int back = 1; back <= kMaxLate; ++back) {
      const auto missing = static_cast<std::uint16_t>(counter - back);
      if (missing == *last_) break;
      if (!others_.has(missing) && !refused_.has(missing)) lost_[next_lost_++ % lost_.size()] = missing;
    }
  }

  std::optional<std::uint16_t> last_;
  std::array<std::optional<std::uint16_t>, kMaxLate> lost_{};
  std::size_t next_lost_ = 0;
  Came others_;
  Came refused_;
};

}  // namespace curbstone::imu::xsens
