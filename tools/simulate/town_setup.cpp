#include "tools/simulate/town_setup.hpp"

#include "tools/simulate/town_surroundings.hpp"

namespace curbstone::simulate {

namespace {

motion::TownMotion tour_motion(const world::Town& town, const TownTour& tour, const rig::SimulateConfig& config) {
  constexpr double kBeforeEnd = 4.0;  // m left at the end of a route, because the spline cuts its corners
  constexpr double kForGood = std::numeric_limits<double>::infinity();
  const motion::TownRoute route = tour.straight > 0 ? motion::TownRoute::along(town)
                                  : tour.opposite   ? motion::TownRoute::there_and_back(town)
                                                    : motion::TownRoute::around(town);
  if (tour.seconds > 0 && route.closed()) return {town, config.vehicle, speed_profile(config, tour.seconds), route};
  const double distance = route.length() + (route.closed() ? TownTour::kAgain : -kBeforeEnd);
  return {town, config.vehicle, speed_profile(config, kForGood, distance), route};
}

}  // namespace

motion::SpeedProfile speed_profile(const rig::SimulateConfig& config, double seconds, double distance) {
  motion::SpeedProfile::Options options;
  options.speed = config.speed;
  options.standstill = config.standstill;
  options.acceleration = config.acceleration;
  options.distance = distance;
  options.manoeuvres = config.manoeuvres;
  if (config.manoeuvres) options.drive = 12.0;  // s: several in a minute
  return {options, seconds};
}

TownSetup::TownSetup(const TownTour& tour, std::int64_t start_utime, const rig::SimulateConfig& config)
    : config_(config),
      town_({.seed = tour.seed,
             .loop = tour.loop,
             .straight = tour.straight,
             .lane_offset = tour.lane,
             .steepness = config.steepness,
             .day = tour.day}),
      ground_(town_, config_.paint),
      motion_(tour_motion(town_, tour, config_)),
      drive_{
          .motion = motion_,
          .make_surroundings =
              [this] { return std::make_unique<TownSurroundings>(town_, config_.lidar, ground_, config_.intensity); },
          .config = config_,
          .rpm = config_.rpm,
          .seed = tour.day != 0 ? tour.day : tour.seed,
          .seconds = tour.seconds > 0 ? tour.seconds : motion_.profile().end() + 2.0,
          .start_utime = start_utime} {}

}  // namespace curbstone::simulate
