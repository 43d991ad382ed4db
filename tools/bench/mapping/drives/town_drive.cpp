#include "tools/bench/mapping/drives/town_drive.hpp"

#include <stdlib.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "tools/bench/mapping/drives/log_player.hpp"
#include "tools/simulate/log_recorder.hpp"
#include "tools/simulate/town_setup.hpp"

namespace curbstone::bench::mapping::drives {
namespace {

constexpr std::int64_t kTownStart = 1'750'000'000'000'000;  // us
constexpr double kTownTruthPeriod = 0.05;                   // s

std::string temporary_file() {
  std::string name = (std::filesystem::temp_directory_path() / "curbstone-town-XXXXXX").string();
  const int fd = mkstemp(name.data());
  if (fd < 0) throw std::runtime_error(name + ": cannot be made");
  close(fd);
  return name;
}

}  // namespace

TownDrive::TownDrive(const Options& options) : lidar_from_(kTownStart + std::llround(options.lidar_from * 1e6)) {
  name = "town";
  prior = "ekf";
  const simulate::TownSetup setup(simulate::TownTour{.seed = options.seed, .seconds = options.seconds}, kTownStart,
                                  options.config);
  vehicle = options.config.vehicle;
  log_ = temporary_file();
  simulate::record_drive(setup.drive(), log_);
  for (double t = 0; t <= options.seconds; t += kTownTruthPeriod) {
    truth_.push_back({kTownStart + std::llround(t * 1e6), setup.motion().T_world_base(t)});
  }
}

TownDrive::~TownDrive() {
  std::error_code ignored;
  std::filesystem::remove(log_, ignored);
}

void TownDrive::play(const Take& take) const {
  play_log(log_, prior != "none", [&](const mapper::scan::Scan& scan, const mapper::scan::OdometryHistory& odometry) {
    if (scan.start >= lidar_from_) take(scan, odometry);
  });
}

}  // namespace curbstone::bench::mapping::drives
