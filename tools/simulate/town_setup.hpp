#pragma once

#include <cstdint>
#include <limits>

#include "tools/simulate/motion/town_motion.hpp"
#include "tools/simulate/paint/painted_ground.hpp"
#include "tools/simulate/rig/drive.hpp"

namespace curbstone::simulate {

/// The configured speed profile, including the initial standstill. After `distance` m the vehicle stops for good.
[[nodiscard]] motion::SpeedProfile speed_profile(const rig::SimulateConfig& config, double seconds,
                                                 double distance = std::numeric_limits<double>::infinity());

/// The town and the route through it.
struct TownTour {
  std::uint64_t seed = 1;
  double seconds = 0;     ///< 0: until it has returned and driven another kAgain
  double loop = 0;        ///< m around a town of several blocks; 0: the demo's block
  double straight = 0;    ///< m of a straight street, bare along its middle half, instead of a town; 0: a town
  std::uint64_t day = 0;  ///< seed of the cars, the bins and all noise; 0: the town's seed
  double lane = -1.3;     ///< m left of the crown
  bool opposite = false;  ///< starts and ends in a street off the loop; returns in the opposite direction

  static constexpr double kAgain = 60.0;  ///< m of the first street driven again, in the same direction
};

/// The town, the drive through it and the sensors' errors, as in `curbstone simulate --town`. The drive refers to the
/// other members, so a setup is neither copied nor moved.
class TownSetup {
 public:
  /// `start_utime`: us since the Unix epoch, of t = 0.
  TownSetup(const TownTour& tour, std::int64_t start_utime, const rig::SimulateConfig& config = {});
  TownSetup(std::uint64_t seed, double seconds, std::int64_t start_utime)
      : TownSetup(TownTour{.seed = seed, .seconds = seconds}, start_utime) {}
  TownSetup(const TownSetup&) = delete;
  TownSetup& operator=(const TownSetup&) = delete;

  [[nodiscard]] const rig::SimulateConfig& config() const { return config_; }
  [[nodiscard]] const world::Town& town() const { return town_; }
  [[nodiscard]] const paint::PaintedGround& ground() const { return ground_; }
  [[nodiscard]] const motion::TownMotion& motion() const { return motion_; }
  [[nodiscard]] const rig::Drive& drive() const { return drive_; }

 private:
  rig::SimulateConfig config_;
  world::Town town_;
  paint::PaintedGround ground_;
  motion::TownMotion motion_;
  rig::Drive drive_;
};

}  // namespace curbstone::simulate
