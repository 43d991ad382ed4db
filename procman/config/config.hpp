#pragma once

#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace curbstone::procman::config {

inline constexpr int kDefaultStopSignal = 2;          ///< SIGINT
inline constexpr double kDefaultStopTimeAllowed = 7;  ///< s

/// Where something is in the file. Two of them are always equal: it is no part of what a command is.
struct Place {
  int line = 0;  ///< from 1; 0: in no file
  bool operator==(const Place&) const { return true; }
};

/// One process as described in the operator's config.
struct Command {
  std::string id;      ///< unique over all deputies; no '/'
  std::string exec;    ///< words in the syntax of parse_exec_line()
  std::string deputy;  ///< the deputy that runs it
  std::string group;   ///< path of the enclosing groups, "drivers/cameras"; empty at the top
  bool auto_respawn = false;
  int stop_signal = kDefaultStopSignal;                ///< 1..64
  double stop_time_allowed = kDefaultStopTimeAllowed;  ///< s from the stop signal to SIGKILL
  double heartbeat = 0;  ///< s without SERVICE_STATUS after which the process counts as hung; 0: not watched
  Place place{};
  bool operator==(const Command&) const = default;
};

enum class TargetKind { kEverything, kGroup, kCommand };
struct Target {
  TargetKind kind = TargetKind::kEverything;
  std::string name;  ///< command id or group path
};

enum class WaitStatus { kNone, kRunning, kReady, kStopped };

enum class ActionKind { kStart, kStop, kRestart, kWaitTime, kWaitStatus, kRunScript };
struct Action {
  ActionKind kind = ActionKind::kStart;
  Target target;                            ///< kStart, kStop, kRestart, kWaitStatus
  WaitStatus wait_for = WaitStatus::kNone;  ///< for kWaitStatus; for the others, what to wait for after acting
  long wait_ms = 0;                         ///< kWaitTime
  std::string script;                       ///< kRunScript
  Place place{};
};

struct Script {
  std::string name;
  std::vector<Action> actions;
  Place place{};
};

/// Contents of a .cfg file, in the order of the file.
struct Config {
  std::vector<Command> commands;
  std::vector<Script> scripts;

  [[nodiscard]] const Command* find_command(std::string_view id) const;
  [[nodiscard]] const Script* find_script(std::string_view name) const;
  /// Ids of the commands that a target names, in the order of the file. A group includes its subgroups.
  [[nodiscard]] std::vector<std::string> resolve(const Target& target) const;
  /// Commands by group, with the groups in the order of their first mention in the file. This is the order of stopping.
  [[nodiscard]] std::vector<std::vector<std::string>> stages() const;
};

/// Syntax error of a config file: "ugv.cfg:3:12: expected ';'", the source line, and a caret below the position.
class ConfigSyntaxError : public std::runtime_error {
 public:
  ConfigSyntaxError(const std::string& what, int line, int column)
      : std::runtime_error(what), line_(line), column_(column) {}
  [[nodiscard]] int line() const { return line_; }      ///< from 1
  [[nodiscard]] int column() const { return column_; }  ///< from 1, in bytes

 private:
  int line_;
  int column_;
};

/// Parses procman's grammar, described in docs/procman.md. `host` is a synonym of `deputy`, as in bot2-procman. `file`
/// names the source in errors. Throws ConfigSyntaxError.
[[nodiscard]] Config parse_config(std::string_view text, const std::string& file);

/// All errors of the commands that the grammar does not exclude, "LINE: what" each: empty or duplicate ids; exec
/// strings that are empty or cannot be split into words; no deputy. Empty if there are none.
[[nodiscard]] std::vector<std::string> check_config(const Config& config);

/// Why the script, or one that it runs, cannot be run, "LINE: what" each: it names something that does not exist, or
/// calls itself. As in procman a file with such a script can be used, but for the script: real files have some.
[[nodiscard]] std::vector<std::string> check_script(const Config& config, const Script& script);

/// Reads a file and checks its commands. Throws std::runtime_error with all errors, "FILE:LINE: what" each.
[[nodiscard]] Config load_config_file(const std::string& file);

/// Errors of check_config() or check_script() as "FILE:LINE: what", one a line.
[[nodiscard]] std::string join_errors(const std::string& file, const std::vector<std::string>& errors);

}  // namespace curbstone::procman::config
