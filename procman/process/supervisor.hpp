#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/shell/event_loop.hpp"
#include "procman/config/config.hpp"
#include "procman/process/adoption.hpp"
#include "procman/process/backoff.hpp"
#include "procman/process/spawn.hpp"
#include "procman/process/timer.hpp"

namespace curbstone::procman::process {

/// The supervisor's state of one command.
struct CommandState {
  config::Command command;  ///< as at the next start
  pid_t pid = 0;            ///< 0: not running. Kept until the last descendant has ended
  int exit_status = 0;      ///< raw status from waitpid(), of the last life; 0 while it runs, and if it was adopted
  bool adopted = false;     ///< the last life was started by an earlier deputy
  bool wanted = false;      ///< should be running: decides on a respawn
  bool stopping = false;
  bool killed = false;          ///< the last life needed SIGKILL
  bool hung = false;            ///< the last life was ended by replace(): SIGKILL was no failure to stop
  bool refused = false;         ///< the last life ended with kExitConfigError: no respawn
  std::int64_t starts = 0;      ///< number of lives so far
  std::int64_t started = 0;     ///< us of steady_clock()
  std::int64_t respawn_at = 0;  ///< us; 0: no start is pending
};

/// Exit status of a Curbstone program whose configuration or options are wrong: it would fail again in the same way.
/// Commands with a heartbeat are such programs.
inline constexpr int kExitConfigError = 2;

/// Starts, watches, respawns and stops processes. It owns all children of this process, which becomes a subreaper
/// (prctl(2)), so that processes that a command leaves behind are stopped too. Runs in the loop's thread. Create it
/// before any other thread, so that SIGCHLD is blocked in all of them.
class Supervisor {
 public:
  struct Events {
    /// Bytes as read from the terminal.
    std::function<void(const std::string& id, std::string_view text)> output;
    /// A command was started.
    std::function<void(const CommandState&)> started;
    /// A command and all its descendants have ended, or it could not be started. `lived` in us.
    std::function<void(const CommandState&, std::int64_t lived)> ended;
  };

  Supervisor(EventLoop& loop, Events events);
  /// Kills all processes that are left.
  ~Supervisor();
  Supervisor(const Supervisor&) = delete;
  Supervisor& operator=(const Supervisor&) = delete;

  /// Adds a command or changes it; a changed exec takes effect at the next start.
  void set(const config::Command& command);
  /// Removes a command: at once if it is not running, else when it has ended.
  void remove(const std::string& id);

  /// Takes over a life of the command that an earlier deputy started. Only if the command is known and not running.
  void adopt(const std::string& id, AdoptedProcess adopted);

  /// No effect if it is running.
  void start(const std::string& id);
  /// Sends the stop signal to the command and its descendants, and SIGKILL when stop_time_allowed has passed.
  void stop(const std::string& id);
  /// Stops it if it is running, and starts it when it has ended.
  void restart(const std::string& id);
  /// Kills a command that hangs, and starts it again. It gets no stop signal: it could not act on it, and if it woke up
  /// a moment later, it would end as if the drive were over.
  void replace(const std::string& id);
  /// Sets whether it is respawned when it ends, without starting or stopping it now.
  void set_wanted(const std::string& id, bool wanted);
  /// Sends SIGKILL at once to everything that is running.
  void kill_all();

  [[nodiscard]] const CommandState* find(const std::string& id) const;
  [[nodiscard]] std::vector<const CommandState*> commands() const;  ///< sorted by id
  [[nodiscard]] bool any_running() const;
  /// Of a running command; -1 if it has none.
  [[nodiscard]] int terminal(const std::string& id) const;
  /// All its living processes, with those that it left behind.
  [[nodiscard]] std::vector<pid_t> family(const std::string& id) const;

 private:
  struct Managed {
    CommandState state;
    SpawnedProcess process;
    Backoff backoff;
    std::string mark;
    FileDescriptor end;        // of an adopted process: readable when it has ended
    pid_t reaper = 0;          // of what an adopted process orphans
    bool leader_gone = false;  // reaped; descendants may still live
    bool remove_at_end = false;
    bool start_at_end = false;
    std::int64_t kill_at = 0;  // us, while stopping
  };

  void launch(Managed& managed);
  void begin_life(Managed& managed);
  void begin_stop(Managed& managed, double time_allowed);
  static void begin_kill(Managed& managed);
  static std::vector<pid_t> family(const Managed& managed);
  static void signal_family(const Managed& managed, int signal);
  void read_output(Managed& managed, std::size_t at_most);
  void close_terminal(Managed& managed);
  void reap();
  void end_if_all_exited(Managed& managed);
  void end_life(Managed& managed);
  void on_timer();
  void arm_timer();

  EventLoop& loop_;
  Events events_;
  std::map<std::string, std::unique_ptr<Managed>> commands_;
  FileDescriptor child_signal_;
  Timer timer_;
};

}  // namespace curbstone::procman::process
