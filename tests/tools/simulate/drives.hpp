#pragma once

#include "common/config/vehicle.hpp"
#include "tools/simulate/motion/town_motion.hpp"
#include "tools/simulate/numerics/random.hpp"
#include "tools/simulate/world/town.hpp"

namespace curbstone::simulate {

/// A drive of 40 s through town 1, shared by the tests of a program.
inline const world::Town& test_town() {
  static const world::Town town({.seed = 1});
  return town;
}
inline const motion::TownMotion& test_motion() {
  static const motion::TownMotion motion(test_town(), VehicleConfig{}, motion::SpeedProfile({}, 40));
  return motion;
}

}  // namespace curbstone::simulate
