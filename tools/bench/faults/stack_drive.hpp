#pragma once

#include <sys/types.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tools/bench/faults/background_program.hpp"
#include "tools/bench/faults/small_disk.hpp"
#include "tools/bench/faults/watched_bus.hpp"

namespace curbstone::bench::faults {

struct StackOptions {
  std::string folder;          ///< for all that comes out; must exist
  std::string spool;           ///< where the emulated packets are kept, for drives of the same length too
  std::string procman_config;  ///< procman/demo.cfg: its script "stack" starts all but the vehicle
  std::string config;          ///< the vehicle's YAML file
  double seconds = 18;         ///< of driving
  std::string simulate;        ///< more options of `curbstone simulate`
  int disk_mb = 0;             ///< size of the disk that the folder lies on; 0: that of the machine
};

/// A drive of the demo's processes under their deputy, in real time over UDP, in which things go wrong. The emulated
/// vehicle is none of them: it goes on whatever is killed. Everything throws std::runtime_error. For one thread.
class StackDrive {
 public:
  /// Returns when the first revolution has been mapped.
  explicit StackDrive(const StackOptions& options);
  ~StackDrive();

  /// Listens until `at` s of the drive, or its end.
  void go_on_until(double at);
  [[nodiscard]] bool over();
  /// s since the first revolution.
  [[nodiscard]] double now() const;

  /// The commands that should run.
  [[nodiscard]] const std::vector<std::string>& commands() const { return commands_; }
  /// kill -9. "deputy" is the deputy itself, which is started again, as systemd does it.
  void kill_command(const std::string& command);
  /// SIGSTOP for so many seconds.
  void freeze(const std::string& command, double seconds);
  /// All processes at once and without a word, then all again.
  void lose_power();
  /// Two commands at the same moment.
  void kill_commands(const std::string& one, const std::string& other);
  /// Nothing more fits on the disk (StackOptions::disk_mb) for so many seconds.
  void fill_disk(double seconds);
  /// The interface that carries the bus and the LiDAR's packets is down for so many seconds. Then it comes up, with the
  /// route of the bus as the system's unit sets it.
  void take_interface_down(double seconds);
  /// So many busy loops for so many seconds.
  void keep_cpu_busy(int loops, double seconds);
  /// From here on faults and the way back count: what goes wrong, goes wrong now or until now.
  void fault_is_over();

  /// Waits for the end of the drive, and until all have stopped.
  void finish();

  /// s from fault_is_over() until all commands ran, spoke and named no fault until the end; empty: not before the end.
  [[nodiscard]] std::optional<double> back_within() const;
  /// What the services said was wrong since the first deed, "service: fault", each once, numbers as '#';
  /// and which of them said nothing at all for 3 s.
  [[nodiscard]] std::vector<std::string> faults_said() const;
  /// Whether the deputy, and so each process, ended by itself when it was asked to.
  [[nodiscard]] bool ended_cleanly() const { return clean_; }
  /// s: how late the emulator sent its latest packet; over 0.1 s the machine had too much to do.
  [[nodiscard]] double emulator_late() const;
  [[nodiscard]] std::string map_file() const { return options_.folder + "/map.db"; }
  [[nodiscard]] std::string log_file() const { return options_.folder + "/run.lcmlog"; }

 private:
  void start_deputy();
  void listen(double seconds);
  void look();
  [[nodiscard]] bool is_well(const std::string& command) const;
  void kill_without_notice(const std::string& command);
  void deed_done();

  StackOptions options_;
  std::unique_ptr<SmallDisk> disk_;  // first: nothing else is open on it when it goes
  WatchedBus bus_;
  std::vector<std::string> commands_;
  std::set<int> killed_;          // pids whose last words do not count
  std::set<std::string> silent_;  // commands that said nothing for too long
  std::int64_t begin_ = 0;        // us, steady, of the first revolution
  std::int64_t over_ = 0;         // us, steady, of the fault
  std::int64_t last_bad_ = 0;     // us, steady
  bool well_ = true;              // when last looked
  bool done_ = false;             // something was done to it
  bool clean_ = false;
  std::vector<pid_t> loops_;
  std::unique_ptr<BackgroundProgram> simulator_, deputy_;
};

}  // namespace curbstone::bench::faults
