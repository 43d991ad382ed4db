#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace curbstone::lidar {

/// Detects lasers that have stopped returning anything: a dead emitter, or dirt in front of it. A laser is silent if it
/// had returns in each of kSteady seconds, and then none for kSilence seconds in each of which lasers above and below
/// it had some; until it has a return again. A laser that points into the sky has none above it with returns; one that
/// never had returns is not missed. Time is that of the points, us; it may jump. Status only. Pure; one thread.
class SilentLasers {
 public:
  static constexpr int kSteady = 10;  ///< s
  static constexpr int kSilence = 5;  ///< s

  /// Adds the rings of a packet's points, 0 is the lowest.
  void add(std::int64_t utime, std::span<const std::uint8_t> rings);
  /// Rings, ascending.
  [[nodiscard]] std::vector<int> silent() const;

 private:
  struct Laser {
    int steady = 0;      // s, up to kSteady
    int silent_for = 0;  // s since then, up to kSilence
  };
  void close_second();
  [[nodiscard]] bool is_between_others(std::size_t ring) const;

  std::array<Laser, 256> lasers_{};
  std::array<int, 256> returns_{};      // of each ring in the current second
  std::optional<std::int64_t> second_;  // the current one
};

}  // namespace curbstone::lidar
