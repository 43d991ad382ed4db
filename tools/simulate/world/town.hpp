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
  double loop = 0;            ///< m round the streets that are driven, several blocks; 0: the demo's single block
  double straight = 0;        ///< m of a straight street, bare along its middle half, instead of a town; 0: a town
  double lane_offset = -1.3;  ///< m left of the crown: where the emulated vehicle drives
  std::uint64_t day = 0;      ///< seed of what does not stay: cars, parked and moving, and bins; 0: as the town's
};

/// A car that circles the loop against the vehicle's direction.
struct MovingCar {
  double start = 0;    ///< m along the loop at time 0
  double speed = 7.0;  ///< m/s
  double lane = 1.45;  ///< m left of the crown
  double reflectivity = 0.4;
};

/// A town from a seed: a street around a block or several, side streets, curbs, driveways, houses, gardens, trees,
/// cars. World frame: z up, origin at the crown of the street where the drive begins, about. The same seed gives the
/// same town.
struct Town {
  explicit Town(const TownOptions& options);

  std::vector<Street> streets;  ///< 0 is the loop, driven counter-clockwise; of several blocks, 1 leads out of it
  std::unique_ptr<const Scene> scene;
  std::vector<MovingCar> cars;
  TownOptions options;

  /// Shapes of the moving cars at a time, in seconds since the drive began.
  void place_cars(double t, std::vector<Shape>& shapes) const;
};

}  // namespace curbstone::simulate::world
