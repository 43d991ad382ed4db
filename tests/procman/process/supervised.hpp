#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "common/shell/event_loop.hpp"
#include "common/time/clock.hpp"
#include "procman/process/supervisor.hpp"

namespace curbstone::procman::process {

/// A supervisor in a loop, what its commands printed, and how their lives ended.
class Supervised {
 public:
  struct End {
    std::string id;
    int status;
    bool killed;
    bool hung;
    std::int64_t at;
  };

  Supervised()
      : supervisor(
            loop,
            {.output =
                 [this](const std::string& id, std::string_view text) {
                   output[id] += text;
                   if (on_output) on_output(id, text);
                 },
             .started = [this](const CommandState& state) { starts[state.command.id].push_back(steady_clock()); },
             .ended =
                 [this](const CommandState& state, std::int64_t) {
                   ends.push_back({state.command.id, state.exit_status, state.killed, state.hung, steady_clock()});
                 }}) {
    loop.every(std::chrono::milliseconds(2), [this] {
      if (tick) tick();
      if (condition() || steady_clock() > deadline_) loop.stop();
    });
  }

  /// Runs the loop until `until` holds; false when it did not within `seconds`.
  bool run_until(std::function<bool()> until, double seconds = 10) {
    condition = std::move(until);
    deadline_ = steady_clock() + static_cast<std::int64_t>(seconds * 1e6);
    loop.run();
    return condition();
  }
  void run_for(double seconds) {
    run_until([] { return false; }, seconds);
  }
  bool run_until_ended(const std::string& id) {
    return run_until([this, id] { return supervisor.find(id)->pid == 0 && supervisor.find(id)->respawn_at == 0; });
  }

  config::Command& add(const std::string& id, const std::string& exec) {
    config::Command& command = commands_[id];
    command.id = id;
    command.exec = exec;
    supervisor.set(command);
    return command;
  }
  void start(const config::Command& command) {
    supervisor.set(command);
    supervisor.start(command.id);
  }

  std::map<std::string, std::string> output;
  std::map<std::string, std::vector<std::int64_t>> starts;
  std::vector<End> ends;
  std::function<void(const std::string&, std::string_view)> on_output;
  std::function<void()> tick;
  std::function<bool()> condition = [] { return false; };
  EventLoop loop;
  Supervisor supervisor;

 private:
  std::map<std::string, config::Command> commands_;
  std::int64_t deadline_ = 0;
};

}  // namespace curbstone::procman::process
