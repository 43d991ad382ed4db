#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace curbstone::imu::xsens {

/// Finds losses by the device's 16-bit packet counter. The device numbers all of its messages in one row: samples, and
/// others such as those of its GNSS receiver. So a number that is missing between two samples is a loss only if no
/// other message had it.
class PacketCounter {
 public:
  /// From the last used sample to this one.
  struct Gap {
    int ahead = 1;  ///< samples, were none lost but samples; 1: this is the next
    int lost = 0;   ///< messages that never came
  };

  /// A message that is no sample.
  void other(std::uint16_t counter) { others_.add(counter); }
  /// A sample that came and is not used.
  void refused(std::uint16_t counter) { refused_.add(counter); }
  /// Empty before the first sample.
  [[nodiscard]] std::optional<Gap> gap(std::uint16_t counter) const {
    if (!last_) return {};
    const auto distance = static_cast<std::uint16_t>(counter - *last_);
    const int ahead = distance - others_.between(*last_, distance);
    return Gap{ahead, std::max(ahead - 1 - refused_.between(*last_, distance), 0)};
  }
  /// The sample with this counter is used.
  void used(std::uint16_t counter) {
    last_ = counter;
    others_ = refused_ = {};
  }
  /// The device counts anew: whatever comes next is the next one.
  void restart() { *this = {}; }

 private:
  /// Counters since the last sample; of more than it holds, the first.
  struct Came {
    std::array<std::uint16_t, 64> counters{};
    std::size_t size = 0;

    void add(std::uint16_t counter) {
      if (size < counters.size()) counters[size++] = counter;
    }
    [[nodiscard]] int between(std::uint16_t last, std::uint16_t distance) const {
      const auto inside = [&](std::uint16_t c) {
        const auto d = static_cast<std::uint16_t>(c - last);
        return d > 0 && d < distance;
      };
      return static_cast<int>(std::ranges::count_if(std::span(counters).first(size), inside));
    }
  };

  std::optional<std::uint16_t> last_;
  Came others_;
  Came refused_;
};

}  // namespace curbstone::imu::xsens
