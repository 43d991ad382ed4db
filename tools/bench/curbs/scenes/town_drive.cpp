#include "tools/bench/curbs/scenes/town_drive.hpp"

#include "tools/evaluate/truth/street_labels.hpp"
#include "tools/simulate/devices/rs16_emulator.hpp"
#include "tools/simulate/recorded/level.hpp"
#include "tools/simulate/recorded/recorded_motion.hpp"
#include "tools/simulate/recorded/scan_surroundings.hpp"
#include "tools/simulate/town_setup.hpp"
#include "tools/simulate/truth/class_grid.hpp"
#include "tools/simulate/truth/curb_lines.hpp"

namespace curbstone::bench::curbs::scenes {

namespace {

constexpr std::int64_t kStart = 1'700'000'000'000'000;  // us

evaluate::truth::Truth truth_of(const simulate::world::Town& town, double vehicle_height) {
  evaluate::truth::Truth truth;
  int line = 0;
  for (const auto& curb : simulate::truth::trace_curbs(town.scene->ground())) {
    for (const simulate::truth::TrueCurbVertex& v : curb)
      truth.curbs.push_back({line, v.foot.x(), v.foot.y(), v.foot.z(), v.height, v.dropped});
    ++line;
  }
  const auto classes = [&](double resolution) {
    simulate::truth::ClassGrid grid = simulate::truth::make_class_grid(*town.scene, vehicle_height, resolution);
    return evaluate::truth::TrueClasses{grid.resolution,  grid.x0,           grid.y0,
                                        grid.image.width, grid.image.height, std::move(grid.image.pixels)};
  };
  truth.classes = classes(simulate::truth::ClassGrid{}.resolution);
  truth.fine_classes = classes(simulate::truth::fine_resolution(*town.scene));
  return truth;
}

}  // namespace

JudgedDrive drive_town(std::uint64_t seed, double seconds) {
  const simulate::TownSetup setup(seed, seconds, kStart);
  JudgedDrive result{.made = drive_tiles(setup.drive()),
                     .truth = truth_of(setup.town(), setup.config().vehicle.height)};
  result.truth.poses = true_trajectory(setup.drive());
  return result;
}

JudgedDrive drive_recorded(const std::string& folder, std::uint64_t seed) {
  constexpr double kRamp = 3.0;  // s from standstill to the recorded speed
  const simulate::recorded::ScanSet scans =
      simulate::recorded::find_scans(folder, folder + "/reference_poses.txt", folder + "/times.txt");
  const simulate::rig::SimulateConfig config;
  const simulate::recorded::Playback playback(config.standstill, kRamp);
  const simulate::recorded::RecordedMotion motion(scans, config.vehicle,
                                                  simulate::recorded::level(scans, config.vehicle.lidar[2]), playback);
  const double rpm = std::clamp(60.0 / scans.period(), 300.0, 1200.0);
  const auto scale = std::make_shared<const simulate::recorded::LaserScale>(scans, config.vehicle.lidar[2]);
  const simulate::rig::Drive drive{
      .motion = motion,
      .make_surroundings =
          [&] {
            return std::make_unique<simulate::recorded::ScanSurroundings>(scans, motion, playback,
                                                                          simulate::devices::Rs16Emulator(), scale);
          },
      .config = config,
      .rpm = rpm,
      .azimuth = -6.0 * rpm * playback.drive_time(0),  // points forward when the recording's head did
      .seed = seed,
      .seconds = playback.drive_time(scans.times.back()),
      .start_utime = kStart};
  JudgedDrive result{.made = drive_tiles(drive), .truth = {}, .T_world_first = motion.T_world_first()};
  result.truth.poses = true_trajectory(drive);
  evaluate::truth::StreetLabels labels = evaluate::truth::read_street_labels(folder, result.T_world_first);
  result.truth.curbs = std::move(labels.curbs);
  result.truth.classes = std::move(labels.classes);
  return result;
}

}  // namespace curbstone::bench::curbs::scenes
