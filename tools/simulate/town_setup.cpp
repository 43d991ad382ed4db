#include "tools/simulate/town_setup.hpp"

#include "tools/simulate/town_surroundings.hpp"

namespace curbstone {

SpeedProfile speed_profile(const SimulateConfig& config, double seconds) {
  SpeedProfile::Options options;
  options.speed = config.speed;
  options.standstill = config.standstill;
  options.acceleration = config.acceleration;
  return {options, seconds};
}

TownSetup::TownSetup(std::uint64_t seed, double seconds, std::int64_t start_utime)
    : town_({.seed = seed}),
      motion_(town_, config_.vehicle, speed_profile(config_, seconds)),
      drive_{.motion = motion_,
             .make_surroundings = [this] { return std::make_unique<TownSurroundings>(town_, config_.lidar); },
             .config = config_,
             .rpm = config_.rpm,
             .seed = seed,
             .seconds = seconds,
             .start_utime = start_utime} {}

}  // namespace curbstone
