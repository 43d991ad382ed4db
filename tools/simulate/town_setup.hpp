#pragma once

#include <cstdint>
#include <limits>

#include "tools/simulate/motion/town_motion.hpp"
#include "tools/simulate/paint/painted_ground.hpp"
#include "tools/simulate/rig/drive.hpp"

namespace curbstone::simulate {

/// How fast, and how long standing first, as the configuration has it. After `distance` m it stands for good.
[[nodiscard]] motion::SpeedProfile speed_profile(const rig::SimulateConfig& config, double seconds,
                                                 double distance = std::numeric_limits<double>::infinity());

/// Which town, and the way through it.
struct TownTour {
  std::uint64_t seed = 1;
  double seconds = 0;     ///< 0: until it has come back and driven kAgain more
  double loop = 0;        ///< m round a town of several blocks; 0: the demo's block
  double straight = 0;    ///< m of a straight street, bare along its middle half, instead; 0: a town
  std::uint64_t day = 0;  ///< seed of the cars, the bins and all noise; 0: as the town's
  double lane = -1.3;     ///< m left of the crown
  bool opposite = false;  ///< begins and ends in a street that leads to the loop: it comes back the other way

  static constexpr double kAgain = 60.0;  ///< m of the first street once more, in the same direction
};

/// The town, the drive through it and the sensors' errors, as `curbstone simulate --town` has them. The drive refers to
/// the rest: a setup stays where it is.
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
