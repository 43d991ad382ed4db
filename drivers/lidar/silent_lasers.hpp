#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace curbstone::lidar {

/// Finds lasers that have stopped returning anything: a dead emitter, or dirt before it. A laser is silent when it
/// returned in each of kSteady seconds, and then nothing at all for kSilence seconds in each of which lasers above and
/// below it did; until it returns something. A laser that looks into the sky has none above it that returns; one that
/// was never heard is not missed. Time is that of the points, us; it may jump. Status only. Pure; one thread.
class SilentLasers {
 public:
  static constexpr int kSteady = 10;  ///< s
  static constexpr int kSilence = 5;  ///< s

  /// The rings of a packet's points, 0 the lowest.
  void add(std::int64_t utime, std::span<const std::uint8_t> rings);
  /// Rings, ascending.
  [[nodiscard]] std::vector<int> silent() const;

 private:
  struct Laser {
    int steady = 0;      // s, up to kSteady
    int silent_for = 0;  // s after that, up to kSilence
  };
  void close_second();
  [[nodiscard]] bool is_between_others(std::size_t ring) const;

  std::array<Laser, 256> lasers_{};
  std::array<int, 256> returns_{};      // of each ring in the running second
  std::optional<std::int64_t> second_;  // the running one
};

}  // namespace curbstone::lidar
