#pragma once

#include <sys/types.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tools/bench/faults/small_disk.hpp"
#include "tools/bench/faults/watched_bus.hpp"
#include "tools/bench/programs/background_program.hpp"
#include "tools/bench/programs/service_manager.hpp"

namespace curbstone::bench::faults {

struct StackOptions {
  std::string folder;          ///< for all output; must exist
  std::string spool;           ///< where the emulated packets are kept, for later drives of the same length too
  std::string procman_config;  ///< procman/demo.cfg: its script "stack" starts all but the vehicle
  std::string config;          ///< the vehicle's YAML file
  double seconds = 18;         ///< of driving
  std::string simulate;        ///< more options of `curbstone simulate`
  int disk_mb = 0;             ///< size of the disk that the folder lies on; 0: that of the machine
};

/// A drive of the demo's processes under their deputy, in real time over UDP, into which faults are injected. The
/// emulated vehicle is not one of these processes and continues whatever is killed. All functions throw
/// std::runtime_error. One thread.
class StackDrive {
 public:
  /// Returns when the first revolution was mapped.
  explicit StackDrive(const StackOptions& options);
  ~StackDrive();

  /// Listens until `at` s of the drive, or until its end.
  void go_on_until(double at);
  [[nodiscard]] bool over();
  /// s since the first revolution.
  [[nodiscard]] double now() const;

  /// The commands that are expected to run.
  [[nodiscard]] const std::vector<std::string>& commands() const { return commands_; }
  /// Sends SIGKILL. "deputy": the deputy itself, which is started again, as systemd does.
  void kill_command(const std::string& command);
  /// Stops a command with SIGSTOP for `seconds`.
  void freeze(const std::string& command, double seconds);
  /// Stops a command with SIGSTOP for good: it hangs.
  void hang(const std::string& command);
  /// Kills all processes at once, then starts all again.
  void lose_power();
  /// Kills two commands at the same moment.
  void kill_commands(const std::string& one, const std::string& other);
  /// Fills the disk (StackOptions::disk_mb) for `seconds`.
  void fill_disk(double seconds);
  /// Takes the interface that carries the bus and the LiDAR's packets down for `seconds`. Then it comes up, with
  /// the route of the bus set as the system's unit sets it.
  void take_interface_down(double seconds);
  /// Runs `loops` busy loops for `seconds`.
  void keep_cpu_busy(int loops, double seconds);
  /// Marks the end of the fault, from which back_within() counts. Without an earlier injection, faults_said() starts
  /// here too.
  void fault_is_over();

  /// Waits for the end of the drive and until all processes have stopped.
  void finish();

  /// s from fault_is_over() until all commands ran, reported and had no fault until the end of the drive; empty: not
  /// before the end.
  [[nodiscard]] std::optional<double> back_within() const;
  /// The faults that services reported since the first injection, "service: fault", each once, numbers as '#', and the
  /// services that were silent for 3 s.
  [[nodiscard]] std::vector<std::string> faults_said() const;
  /// Whether the deputy, and so each process, ended by itself on request.
  [[nodiscard]] bool ended_cleanly() const { return clean_; }
  /// s, largest delay of the emulator's packets; over 0.1 s the machine was too busy.
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
  std::unique_ptr<SmallDisk> disk_;  // first member: destroyed when nothing on it is open any more
  WatchedBus bus_;
  std::vector<std::string> commands_;
  std::set<int> killed_;          // pids whose last status does not count
  std::set<std::string> silent_;  // commands that were silent for too long
  std::int64_t begin_ = 0;        // us, steady, of the first revolution
  std::int64_t over_ = 0;         // us, steady, of the fault
  std::int64_t last_bad_ = 0;     // us, steady
  bool well_ = true;              // at the last check
  bool done_ = false;             // a fault was injected
  bool clean_ = false;
  std::vector<pid_t> loops_;
  programs::ServiceManager manager_;  // of the deputy, as systemd is
  std::unique_ptr<programs::BackgroundProgram> simulator_, deputy_;
};

}  // namespace curbstone::bench::faults
