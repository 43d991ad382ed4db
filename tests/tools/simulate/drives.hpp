#pragma once

#include "common/vehicle.hpp"
#include "tools/simulate/motion/town_motion.hpp"
#include "tools/simulate/random.hpp"
#include "tools/simulate/world/town.hpp"

namespace curbstone {

/// A drive of 40 s through town 1, shared by the tests of a program.
inline const Town& test_town() {
  static const Town town({.seed = 1});
  return town;
}
inline const TownMotion& test_motion() {
  static const TownMotion motion(test_town(), VehicleConfig{}, SpeedProfile({}, 40));
  return motion;
}

}  // namespace curbstone
