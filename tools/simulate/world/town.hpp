#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "tools/simulate/numerics/random.hpp"
#include "tools/simulate/world/scene.hpp"
#include "tools/simulate/world/street.hpp"

namespace curbstone::simulate::world {

struct TownOptions {
  std::uint64_t seed = 1;
  double loop = 0;            ///< m around the driven streets, several blocks; 0: the demo's single block
  double straight = 0;        ///< m of a straight street, bare along its middle half, instead of a town; 0: a town
  double lane_offset = -1.3;  ///< m left of the crown, lane of the emulated vehicle
  double steepness = 0.04;    ///< maximum slope of the terrain
  std::uint64_t day = 0;      ///< seed of what changes daily: cars, parked and moving, and bins; 0: the town's seed
};

/// A car that drives around the loop in the opposite direction.
struct MovingCar {
  double start = 0;    ///< m along the loop at time 0
  double speed = 7.0;  ///< m/s
  double lane = 1.45;  ///< m left of the crown
  double reflectivity = 0.4;
};

/// A town generated from a seed: a street around one block or several, side streets, curbs, driveways, houses, gardens,
/// trees, cars. World frame: z up, origin approximately at the crown of the street where the drive begins. The same
/// seed gives the same town.
struct Town {
  explicit Town(const TownOptions& options);

  std::vector<Street> streets;  ///< 0 is the loop, driven counter-clockwise; with several blocks, 1 leads out of it
  std::unique_ptr<const Scene> scene;
  std::vector<MovingCar> cars;
  TownOptions options;

  /// Shapes of the moving cars at a time, s since the drive began.
  void place_cars(double t, std::vector<Shape>& shapes) const;
};

}  // namespace curbstone::simulate::world
