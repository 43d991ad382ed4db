#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace curbstone::encoder {

/// Detects a wheel whose count stands still while the drive reports that the wheel turns: its encoder is unplugged, or
/// the drive or a gateway repeats old values. Pure; one thread.
class StuckCounts {
 public:
  using Speeds = std::array<std::int16_t, 2>;           ///< 0.1 rpm, left and right
  static constexpr std::int64_t kPatience = 1'000'000;  ///< us
  static constexpr int kTurning = 20;                   ///< 0.1 rpm: a lower speed is noise
  static constexpr double kMinCounts = 8;               ///< minimum of missing counts
  static constexpr std::uint16_t kFault = 0x0800;       ///< bit "encoder" of the drive's fault word

  explicit StuckCounts(double counts_per_revolution) : counts_per_revolution_(counts_per_revolution) {}

  /// Adds counts as sent by the drive, at `time` us, and the speeds that it reports, if they are current.
  void add(std::int64_t time, const std::array<std::int32_t, 2>& counts, const std::optional<Speeds>& speeds);
  /// Restarts.
  void restart() { wheels_ = {}; }
  [[nodiscard]] bool stuck(std::size_t wheel) const;
  /// Neither count is usable.
  [[nodiscard]] bool all_stuck() const { return stuck(0) && stuck(1); }
  [[nodiscard]] std::vector<std::string> faults() const;

 private:
  struct Wheel {
    std::optional<std::int32_t> count;
    std::int64_t last = 0;   // us
    std::int64_t since = 0;  // us, since when it turns and does not count
    double missing = 0;      // counts
  };
  double counts_per_revolution_;
  std::array<Wheel, 2> wheels_;
};

}  // namespace curbstone::encoder
