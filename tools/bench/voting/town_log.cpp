#include "tools/bench/voting/town_log.hpp"

#include <memory>

#include "tools/simulate/log_recorder.hpp"
#include "tools/simulate/motion/town_motion.hpp"
#include "tools/simulate/town_surroundings.hpp"

namespace curbstone {

void record_town_log(std::uint64_t seed, double seconds, const std::string& file) {
  const SimulateConfig config;
  TownOptions options;
  options.seed = seed;
  const Town town(options);
  SpeedProfile::Options speed;
  speed.speed = config.speed;
  speed.standstill = config.standstill;
  speed.acceleration = config.acceleration;
  const TownMotion motion(town, config.vehicle, SpeedProfile(speed, seconds));
  const Drive drive{.motion = motion,
                    .make_surroundings = [&] { return std::make_unique<TownSurroundings>(town, config.lidar); },
                    .config = config,
                    .rpm = config.rpm,
                    .seed = seed,
                    .seconds = seconds,
                    .start_utime = 1'750'000'000'000'000};
  record_drive(drive, file);
}

}  // namespace curbstone
