#include "tools/bench/curbs/town_drive.hpp"

#include "tools/evaluate/street_labels.hpp"
#include "tools/simulate/recorded/level.hpp"
#include "tools/simulate/recorded/recorded_motion.hpp"
#include "tools/simulate/recorded/scan_surroundings.hpp"
#include "tools/simulate/town_setup.hpp"
#include "tools/simulate/truth/class_grid.hpp"
#include "tools/simulate/truth/curb_lines.hpp"

namespace curbstone {

namespace {

constexpr std::int64_t kStart = 1'700'000'000'000'000;  // us

Truth truth_of(const Town& town, double vehicle_height) {
  Truth truth;
  int line = 0;
  for (const auto& curb : trace_curbs(town.scene->ground())) {
    for (const TrueCurbVertex& v : curb)
      truth.curbs.push_back({line, v.foot.x(), v.foot.y(), v.foot.z(), v.height, v.dropped});
    ++line;
  }
  ClassGrid grid = make_class_grid(*town.scene, vehicle_height);
  truth.classes = {grid.resolution,  grid.x0,           grid.y0,
                   grid.image.width, grid.image.height, std::move(grid.image.pixels)};
  return truth;
}

}  // namespace

JudgedDrive drive_town(std::uint64_t seed, double seconds) {
  const TownSetup setup(seed, seconds, kStart);
  JudgedDrive result{.made = drive_tiles(setup.drive()),
                     .truth = truth_of(setup.town(), setup.config().vehicle.height)};
  result.truth.poses = true_trajectory(setup.drive());
  return result;
}

JudgedDrive drive_recorded(const std::string& folder, std::uint64_t seed) {
  constexpr double kRamp = 3.0;  // s from standing to the recording's own pace
  const ScanSet scans = find_scans(folder, folder + "/reference_poses.txt", folder + "/times.txt");
  const SimulateConfig config;
  const Playback playback(config.standstill, kRamp);
  const RecordedMotion motion(scans, config.vehicle, level(scans, config.vehicle.lidar[2]), playback);
  const double rpm = std::clamp(60.0 / scans.period(), 300.0, 1200.0);
  const Drive drive{
      .motion = motion,
      .make_surroundings =
          [&] { return std::make_unique<ScanSurroundings>(scans, motion, playback, Rs16EmulatorConfig().elevations); },
      .config = config,
      .rpm = rpm,
      .azimuth = -6.0 * rpm * playback.drive_time(0),  // looks forward when the recording's head did
      .seed = seed,
      .seconds = playback.drive_time(scans.times.back()),
      .start_utime = kStart};
  JudgedDrive result{.made = drive_tiles(drive), .truth = {}};
  result.truth.poses = true_trajectory(drive);
  StreetLabels labels = read_street_labels(folder, motion.T_world_first());
  result.truth.curbs = std::move(labels.curbs);
  result.truth.classes = std::move(labels.classes);
  return result;
}

}  // namespace curbstone
