#include "tools/bench/curbs/scenes/drive_tiles.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>

#include <filesystem>

#include "tools/simulate/log_recorder.hpp"

namespace curbstone::bench::curbs::scenes {

namespace {

/// A temporary file that is removed with this object.
class TemporaryLog {
 public:
  TemporaryLog()
      : path_((std::filesystem::temp_directory_path() / fmt::format("curbstone_bench_{}.lcmlog", getpid())).string()) {}
  ~TemporaryLog() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  TemporaryLog(const TemporaryLog&) = delete;
  TemporaryLog& operator=(const TemporaryLog&) = delete;
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

}  // namespace

DriveTiles drive_tiles(const simulate::rig::Drive& drive) {
  const TemporaryLog log;
  simulate::record_drive(drive, log.path());
  return vote_log(log.path());
}

evaluate::truth::Trajectory true_trajectory(const simulate::rig::Drive& drive) {
  evaluate::truth::Trajectory trajectory;
  for (double t = 0; t <= drive.seconds; t += 0.05)
    trajectory.push_back({drive.start_utime + std::llround(t * 1e6), drive.motion.T_world_base(t)});
  return trajectory;
}

}  // namespace curbstone::bench::curbs::scenes
