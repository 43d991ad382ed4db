#pragma once

#include <curbstone/map_pose_t.hpp>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tests/system/cpu_pressure.hpp"
#include "tests/system/run_program.hpp"
#include "tests/temporary_folder.hpp"
#include "tools/bench/faults/watched_bus.hpp"

namespace curbstone::system_test {

/// How many cells of each class a map file has (index: CellClass), and in how many tiles.
struct MapContent {
  std::vector<int> cells = std::vector<int>(5);
  int tiles = 0;
  int curb_lines = 0;
  std::string integrity;
};
[[nodiscard]] MapContent read_map(const std::string& file);

/// Share of the cells that either map knows in which both have the same class, 0..1.
[[nodiscard]] double agreement(const std::string& map_file, const std::string& other_map_file);

/// What the emulated vehicle carries, by the names that scripts/demo takes, and where its page is.
struct DemoDevices {
  std::string imu = "xsens";
  std::string encoder = "can";
  std::string lidar = "rs16";
  int viewer_port = 0;  ///< of the page; 0: any. A page finds a viewer that was started again only at the same one
};

/// The real processes of procman/demo.cfg under the deputy, driven by the emulated vehicle in real time over UDP.
class DemoDrive {
 public:
  /// `source`: what the vehicle drives through, as `curbstone simulate` takes it.
  explicit DemoDrive(const std::string& source, const std::string& deputy_options = "",
                     const DemoDevices& devices = {});

  /// Until the mapper has registered `revolutions` revolutions; false when that does not come.
  bool wait_for_scans(int revolutions);
  /// Until the drive is over and everything has stopped; the deputy's exit status.
  int wait_for_end();
  /// kill -9 to a process; true when the deputy has brought it back, and it speaks again.
  bool kill_and_see_it_come_back(const std::string& command);

  /// Makes the map again from the recorded sensors' messages, in one process; its file.
  [[nodiscard]] std::string replay() const;

  [[nodiscard]] MapContent map() const { return read_map(map_file()); }
  [[nodiscard]] std::string map_file() const { return folder_ / "map.db"; }
  /// That the drive has left: its own, and those kept of drives before.
  [[nodiscard]] int map_files() const;
  [[nodiscard]] std::string output() const { return deputy_->output(); }
  /// What the processes lost, by "service counter"; empty when nothing was.
  [[nodiscard]] std::vector<std::string> losses() const;
  /// That the machine had other things to do, in words, once the drive is over: the emulator sent its latest packet
  /// later than buffers bridge, or some program waited for the CPU nearly all of the time. What is lost or late then
  /// says nothing about the processes. Empty: it had not.
  [[nodiscard]] std::string spoiled_by() const;

  /// The services that are not well, and why; of `names`, which have not all spoken yet.
  [[nodiscard]] std::map<std::string, std::string> unwell(const std::vector<std::string>& names) const;

  bench::faults::WatchedBus bus;
  map_pose_t pose{};
  int revolutions = 0;
  /// m that the vehicle had come from its start when the first SEMANTIC_TILE was heard, and when what that shows was
  /// seen.
  std::optional<double> driven_until_first_tile, driven_until_seen;

 private:
  static constexpr double kEmulatorLate = 0.1;  // s
  static constexpr double kBusy = 0.85;         // share of the drive's time

  std::map<std::int64_t, double> driven_;  // m, by utime, until there is a tile
  CpuPressure pressure_;
  double pressure_share_ = 0;  // at the drive's end
  test::TemporaryFolder folder_;
  std::unique_ptr<BackgroundProgram> deputy_;
};

}  // namespace curbstone::system_test
