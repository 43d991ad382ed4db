#pragma once

#include <cstdint>

#include "tools/simulate/drive.hpp"
#include "tools/simulate/motion/town_motion.hpp"

namespace curbstone {

/// How fast, and how long standing first, as the configuration has it.
[[nodiscard]] SpeedProfile speed_profile(const SimulateConfig& config, double seconds);

/// The demo's town and the drive through it, as `curbstone simulate --town` has them with its defaults. The drive refers
/// to the rest: a setup stays where it is.
class TownSetup {
 public:
  /// `start_utime`: us since the Unix epoch, of t = 0.
  TownSetup(std::uint64_t seed, double seconds, std::int64_t start_utime);
  TownSetup(const TownSetup&) = delete;
  TownSetup& operator=(const TownSetup&) = delete;

  [[nodiscard]] const SimulateConfig& config() const { return config_; }
  [[nodiscard]] const Town& town() const { return town_; }
  [[nodiscard]] const TownMotion& motion() const { return motion_; }
  [[nodiscard]] const Drive& drive() const { return drive_; }

 private:
  SimulateConfig config_;
  Town town_;
  TownMotion motion_;
  Drive drive_;
};

}  // namespace curbstone
