#pragma once

#include <sys/types.h>

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "common/bus/lcm_bus.hpp"
#include "common/shell/event_loop.hpp"
#include "common/shell/status_reporter.hpp"
#include "procman/config/config.hpp"
#include "procman/deputy/adoptions.hpp"
#include "procman/deputy/alarms.hpp"
#include "procman/deputy/deputy.hpp"
#include "procman/deputy/deputy_config.hpp"
#include "procman/deputy/doctor_run.hpp"
#include "procman/deputy/heartbeats.hpp"
#include "procman/deputy/script_runner.hpp"
#include "procman/deputy/start_sequence.hpp"
#include "procman/output/console.hpp"
#include "procman/output/output_keeper.hpp"
#include "procman/process/stop_sequence.hpp"
#include "procman/process/supervisor.hpp"

namespace curbstone::procman::deputy {

/// The process `curbstone-deputy`: a deputy on the bus that also runs its own config without a sheriff. One thread,
/// and those that print: nothing that the vehicle needs waits for who reads the output.
class DeputyApp {
 public:
  /// Throws UsageError, or std::runtime_error if the environment fails.
  explicit DeputyApp(DeputyAppOptions options);
  /// Runs until a signal or the end of `exit_when`. Then it stops everything, stage by stage; a second signal kills.
  /// Returns the exit status: 0 clean, 1 `exit_when` failed, 2 another deputy has this id.
  int run();

 private:
  void begin();
  void tick();
  void shut_down();
  void on_status(const service_status_t& status);
  void replace_hung(std::int64_t now);
  void run_doctor(std::int64_t now);
  void on_doctor(DoctorResult result);
  void publish_status(std::int64_t now);
  [[nodiscard]] bool is_up(const std::string& id) const;
  [[nodiscard]] bool has_reached(const std::string& id, config::WaitStatus wanted) const;
  void on_started(const process::CommandState& state);
  void on_ended(const process::CommandState& state, std::int64_t lived);
  void log_line(const std::string& text);
  void print_line(const std::string& id, std::string_view line);
  void show_last_lines(const std::string& id);
  void resend_last_lines();

  DeputyAppOptions options_;
  Adoptions adoptions_;  // before what opens files
  output::Console console_;
  output::Console errors_;
  config::Config config_;  // commands of this deputy only
  EventLoop loop_;
  output::OutputKeeper keeper_;
  process::Supervisor supervisor_;
  std::unique_ptr<LcmBus> bus_;
  std::unique_ptr<Deputy> deputy_;
  process::FileDescriptor other_signals_;  // SIGHUP, SIGQUIT
  Heartbeats heartbeats_;
  Alarms alarms_;
  std::optional<StatusReporter> reporter_;
  std::optional<DoctorRun> doctor_;
  bool doctor_done_ = false;           // doctor_ has reported its findings
  std::int64_t doctor_due_ = 0;        // us; 0: not scheduled
  std::vector<std::string> findings_;  // current findings
  std::optional<StartSequence> starting_;
  std::optional<ScriptRunner> script_;
  std::optional<process::StopSequence> stopping_;
  bool kills_ = false;                     // as a second signal asks: no command has failed to stop
  std::map<std::string, int> short_runs_;  // consecutive short lives, by command
  bool begun_ = false;
  int status_ = 0;
  std::int64_t end_at_ = 0;      // us; 0: not yet known
  std::int64_t second_due_ = 0;  // us
};

}  // namespace curbstone::procman::deputy
