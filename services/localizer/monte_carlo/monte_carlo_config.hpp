#pragma once

#include "common/config/config.hpp"

namespace curbstone::localizer::monte_carlo {

/// Section `mcl`. Defaults are those of AMCL where it has them.
struct MonteCarloConfig {
  int particles = 2000;
  int min_particles = 500;
  int beams = 60;
  double sigma_hit = 0.2;
  double z_hit = 0.5;
  double z_rand = 0.05;
  double kld_error = 0.05;
  double kld_quantile = 2.33;
  double update_m = 0.2;
  double update_rad = 0.2;
  int seed = 1;

  void visit(ConfigVisitor& v) {
    v.field("particles", particles, {10, 100'000}, "at most");
    v.field("min_particles", min_particles, {10, 100'000}, "at least, where that is less");
    v.field("beams", beams, {1, 2000}, "points of a revolution that are compared with the map");
    v.field("sigma_hit", sigma_hit, {0.001, 2.0}, "m, 1 sigma of a point on an upright object relative to the map");
    v.field("z_hit", z_hit, {0.0, 1.0}, "weight of points that the map explains");
    v.field("z_rand", z_rand, {0.0, 1.0}, "likelihood of a point that it does not");
    v.field("kld_error", kld_error, {0.001, 1.0}, "most that the particles' distribution may differ from the true one");
    v.field("kld_quantile", kld_quantile, {0.1, 5.0}, "upper quantile of the normal distribution for that to hold");
    v.field("update_m", update_m, {0.0, 5.0}, "m driven, or");
    v.field("update_rad", update_rad, {0.0, 3.0}, "rad turned, before another revolution is compared");
    v.field("seed", seed, {0, 1'000'000}, "of the random numbers");
  }
};

}  // namespace curbstone::localizer::monte_carlo
