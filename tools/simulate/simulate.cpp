#include "tools/simulate/simulate.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/config/command_line.hpp"
#include "common/log/log_reader.hpp"
#include "common/time/clock.hpp"
#include "config/sections.hpp"
#include "tools/output/new_file.hpp"
#include "tools/simulate/live/live_drive.hpp"
#include "tools/simulate/log_recorder.hpp"
#include "tools/simulate/recorded/level.hpp"
#include "tools/simulate/recorded/recorded_motion.hpp"
#include "tools/simulate/recorded/scan_surroundings.hpp"
#include "tools/simulate/town_setup.hpp"
#include "tools/simulate/truth/truth_folder.hpp"

namespace curbstone::simulate {

namespace {

struct Options {
  bool town = false;
  bool live = false;
  bool seconds_given = false;
  bool force = false;
  double loop = 0, straight = 0;
  bool opposite = false;
  std::uint64_t seed = 1;
  std::uint64_t day = 0;
  double lane = -1.3;
  double seconds = 60;
  std::int64_t start_utime = 1'750'000'000'000'000;
  devices::LidarName lidar = devices::LidarName::kRs16;
  std::string log, truth, config, scans, poses, times, devices;
  std::vector<std::string> set, faults;
  live::LiveOptions to_devices;
};

/// What a drive is simulated from, whatever its source, with the truth about it.
struct Source {
  std::unique_ptr<TownSetup> town;
  std::unique_ptr<motion::Motion> recorded;
  const motion::Motion* motion = nullptr;  ///< one of the two above
  std::function<std::unique_ptr<sensors::Surroundings>()> make_surroundings;
  std::string name;
  double seconds = 0;
  double rpm = 0;
  double azimuth = 0;  ///< deg, of the LiDAR's head at t = 0
  // Only for a recorded drive:
  std::shared_ptr<const recorded::ScanSet> scans;
};

Source town_source(const Options& options, const rig::SimulateConfig& config) {
  TownTour tour{.seed = options.seed,
                .seconds = options.seconds,
                .loop = options.loop,
                .straight = options.straight,
                .day = options.day,
                .lane = options.lane,
                .opposite = options.opposite};
  if ((options.loop > 0 || options.straight > 0) && !options.seconds_given) tour.seconds = 0;
  Source source;
  source.town = std::make_unique<TownSetup>(tour, options.start_utime, config);
  source.motion = &source.town->motion();
  source.make_surroundings = source.town->drive().make_surroundings;
  source.name = "town";
  source.seconds = source.town->drive().seconds;
  source.rpm = config.rpm;
  return source;
}

Source recorded_source(const Options& options, const rig::SimulateConfig& config) {
  constexpr double kRamp = 3.0;  // s from standstill to the recorded speed
  Source source;
  source.scans =
      std::make_shared<const recorded::ScanSet>(recorded::find_scans(options.scans, options.poses, options.times));
  const recorded::ScanSet& scans = *source.scans;
  const recorded::Playback playback(config.standstill, kRamp);
  auto motion = std::make_unique<recorded::RecordedMotion>(scans, config.vehicle,
                                                           recorded::level(scans, config.vehicle.lidar[2]), playback);
  source.rpm = std::clamp(60.0 / scans.period(), 300.0, 1200.0);
  const std::shared_ptr<const devices::LidarEmulator> lidar = devices::make_lidar(options.lidar, source.rpm);
  const auto scale = std::make_shared<const recorded::LaserScale>(scans, config.vehicle.lidar[2]);
  source.make_surroundings = [scans = source.scans, at = motion.get(), playback, lidar, scale] {
    return std::make_unique<recorded::ScanSurroundings>(*scans, *at, playback, *lidar, scale);
  };
  source.recorded = std::move(motion);
  source.motion = source.recorded.get();
  source.name = options.scans;
  source.seconds = playback.drive_time(scans.times.back());
  if (options.seconds_given) source.seconds = std::min(source.seconds, options.seconds);
  source.azimuth = -6.0 * source.rpm * playback.drive_time(0);  // points forward when the recording's head did
  return source;
}

/// Writes the truth folder, if it is wanted: at once what is known before the drive, the rest in finish().
class TruthWriter {
 public:
  TruthWriter(const Options& options, const rig::SimulateConfig& config, const Source& source)
      : options_(options), source_(source) {
    if (!options.truth.empty() && source.town)
      classes_ = truth::write_town_truth(options.truth, source.town->town(), source.town->ground().markings(),
                                         config.vehicle.height);
  }
  void finish(std::int64_t start_utime, double seconds, std::optional<double> latest_packet = {}) const {
    if (options_.truth.empty()) return;
    truth::write_drive_truth(options_.truth, {start_utime, options_.seed, source_.name, seconds, latest_packet},
                             *source_.motion, classes_);
  }

 private:
  const Options& options_;
  const Source& source_;
  std::optional<truth::ClassImageInfo> classes_;
};

double way_of(const Source& source, double seconds) {
  double way = 0;
  Pose last = source.motion->T_world_base(0);
  for (double t = 0.1; t <= seconds; t += 0.1) {
    const Pose next = source.motion->T_world_base(t);
    way += (next.translation() - last.translation()).norm();
    last = next;
  }
  return way;
}

/// Whether the file can be made again: it is empty, or a log of an emulated drive that begins at `start_utime`. A
/// recorded drive cannot be made again.
bool can_be_made_again(const std::string& file, std::int64_t start_utime) {
  constexpr std::int64_t kFirst = 10'000'000;  // us, within which a drive sends something
  std::error_code not_there;
  if (std::filesystem::file_size(file, not_there) == 0) return true;
  try {
    const auto first = LogReader(file).next();
    return first && first->log_utime >= start_utime && first->log_utime < start_utime + kFirst;
  } catch (const std::runtime_error&) {
    return false;
  }
}

void simulate_to_log(const Options& options, const rig::SimulateConfig& config, const Source& source,
                     const rig::Drive& drive) {
  const auto begin = steady_clock();
  output::NewFile log(options.log, options.force || can_be_made_again(options.log, options.start_utime));
  TruthWriter(options, config, source).finish(options.start_utime, drive.seconds);
  const Recorded recorded = record_drive(drive, log.part());
  log.commit();
  const double took = static_cast<double>(steady_clock() - begin) * 1e-6;
  fmt::print(
      "simulate: {:.1f} s, {:.1f} m: {} LiDAR packets; {} LIDAR_POINTS, {} IMU, {} WHEELS in {} ({:.1f} x real time)\n",
      drive.seconds, way_of(source, drive.seconds), recorded.packets, recorded.lidar, recorded.imu, recorded.wheels,
      options.log, drive.seconds / took);
}

void simulate_live(const Options& options, const rig::SimulateConfig& config, const Source& source,
                   const rig::Drive& drive) {
  const TruthWriter truth(options, config, source);
  const live::LiveReport report = live::run_live(drive, options.to_devices, [](std::int64_t) {
    fmt::print("simulate: the drive begins\n");
    std::fflush(stdout);
  });
  truth.finish(report.start_utime, report.seconds, report.latest);
  fmt::print(
      "simulate: {:.1f} of {:.1f} s, {:.1f} m live: {} LiDAR packets ({:.1f} ms late at most), {} IMU samples, {} "
      "messages of the wheels{}\n",
      report.seconds, drive.seconds, way_of(source, report.seconds), report.packets, report.latest * 1e3, report.imu,
      report.wheels, report.interrupted ? "; interrupted" : "");
}

void add_options(CommandLine& line, Options& options) {
  line.flag("--town", options.town, "Drive round the block in a town made from the seed");
  line.option("--loop", options.loop, "m round several blocks of the town, until it has come back (or --seconds)")
      .within(600.0, 4000.0);
  line.option("--straight", options.straight,
              "m of a straight street of the town, with nothing but curbs along its middle half")
      .within(200.0, 2000.0);
  line.flag("--opposite", options.opposite, "With --loop: comes back to its first street the other way");
  line.option("--scans", options.scans, "Drive a recording again: folder of KITTI scans (*.bin), with --poses");
  line.option("--poses", options.poses, "Pose of each scan: 3x4 rows, lidar frame, to the first");
  line.option("--times", options.times, "Time of each scan, s; default: times.txt beside the poses, else 10 Hz");
  line.option("--seed", options.seed, "Of the town and of all noise").shows_default();
  line.option("--day", options.day, "Seed of what does not stay in the town, cars and bins, and of all noise");
  line.option("--lane", options.lane, "m left of the crown of the street, in the town")
      .within(-2.0, 2.0)
      .shows_default();
  line.option("--seconds", options.seconds, "Length of the drive").within(0.1, 36000.0).shows_default();
  using enum devices::LidarName;
  line.choice("--lidar", options.lidar,
              {{"rs16", kRs16}, {"vlp16", kVlp16}, {"helios16p", kHelios16p}, {"helios32", kHelios32}},
              "The LiDAR on the roof");
  line.option("--truth", options.truth, "Folder for the true poses, classes and curbs");
  line.option("--config", options.config, "The vehicle's YAML file (sections simulate and vehicle)");
  line.option("--set", options.set, "KEY=VALUE of section simulate, e.g. speed=2 or lidar.range_sigma=0.03");
  line.heading("To a log");
  line.option("--log", options.log, "Write an LCM log, as fast as it goes");
  line.flag("--force", options.force, "Replace a file that is there and is no emulated drive of that beginning");
  line.option("--start-utime", options.start_utime, "us since the epoch, of the beginning").shows_default();
  live::LiveOptions& live = options.to_devices;
  line.heading("Live, as devices");
  line.flag("--live", options.live, "Send packets and serial bytes in real time");
  line.option("--lidar-host", live.lidar_host, "Where the LiDAR's packets go").shows_default();
  line.option("--msop-port", live.msop_port, "Of the point packets; default: the device's own").within(1, 65535);
  line.option("--difop-port", live.difop_port, "Of the device information; default: the device's own").within(1, 65535);
  line.option("--devices", options.devices, "Folder for the serial ports, as imu and can: short for both links");
  line.option("--imu-link", live.imu_link, "Name for the IMU's serial port").shows_default();
  line.option("--can-link", live.can_link, "Name for the serial port of the CAN adapter, or of the drive")
      .shows_default();
  line.choice("--imu", live.witmotion, {{"xsens", false}, {"witmotion", true}}, "The IMU that is emulated");
  line.choice("--encoder", live.modbus, {{"can", false}, {"modbus", true}},
              "The wheels' line: CAN by an SLCAN adapter");
  line.option("--spool", live.spool, "File for the packets rendered ahead; the next run takes them from there");
  line.option("--head-start", live.head_start, "s that the devices are on before the drive begins").within(0.0, 600.0);
  line.option("--fault", options.faults, "lidar|imu|wheels-silent|garbage:FROM-TO, seconds of the drive; repeatable");
}

std::uint64_t fingerprint(const Options& options, AnyConfig& config) {
  const std::string all =
      fmt::format("6 {} {} {} {} {} {} {} {} {} {} {} {}", static_cast<int>(options.lidar), options.town, options.scans,
                  options.poses, options.seed, options.seconds, options.loop, options.straight, options.opposite,
                  options.day, options.lane, dump_config("simulate", config));
  std::uint64_t hash = 0;
  for (const char c : all) hash = numerics::mix_bits(hash ^ static_cast<unsigned char>(c));
  return hash;
}

/// Throws ConfigError for what is wrong in what the user wrote.
void check(Options& options) {
  options.town = options.town || options.loop > 0 || options.straight > 0;
  if (options.town == !options.scans.empty())
    throw ConfigError("what to drive through: a town (--town, --loop M or --straight M), or --scans DIR --poses FILE");
  if (options.straight > 0 && options.loop > 0) throw ConfigError("a street is a --loop, or it is --straight");
  if (options.day != 0 && !options.town) throw ConfigError("--day belongs to --town");
  if (options.opposite && options.loop == 0) throw ConfigError("--opposite belongs to --loop");
  if (options.scans.empty() != options.poses.empty()) throw ConfigError("--scans and --poses belong together");
  if (options.live == !options.log.empty()) throw ConfigError("either --log FILE or --live");
  if (!options.devices.empty()) {
    options.to_devices.imu_link = options.devices + "/imu";
    options.to_devices.can_link = options.devices + "/can";
  }
  for (const auto& text : options.faults) {
    const auto fault = rig::parse_fault(text);
    if (!fault)
      throw ConfigError(fmt::format("--fault {}: expected for instance imu-silent:10-12 or lidar-garbage:5-6", text));
    options.to_devices.faults.add(*fault);
  }
}

}  // namespace

int run_simulate(int argc, char** argv) {
  Options options;
  CommandLine line("An emulated vehicle: what its sensors would send on a drive, and the truth about it",
                   "curbstone simulate");
  add_options(line, options);
  if (const auto status = line.read(argc, argv)) return *status;
  options.seconds_given = line.given("--seconds");
  ConfigOf<rig::SimulateConfig> config;
  if (!options.config.empty()) load_config(options.config, "simulate", kProcessSections, config);
  for (const auto& assignment : options.set) set_config_value(assignment, config);
  check(options);

  if (!options.truth.empty()) truth::prepare_truth_folder(options.truth);
  if (!options.devices.empty()) std::filesystem::create_directories(options.devices);
  const Source source = options.town ? town_source(options, config.value) : recorded_source(options, config.value);
  const rig::Drive drive{*source.motion, source.make_surroundings, config.value,
                         source.rpm,     source.azimuth,           options.day != 0 ? options.day : options.seed,
                         source.seconds, options.start_utime,      options.lidar};
  options.to_devices.fingerprint = fingerprint(options, config);
  if (options.live) {
    simulate_live(options, config.value, source, drive);
  } else {
    simulate_to_log(options, config.value, source, drive);
  }
  return 0;
}

}  // namespace curbstone::simulate
