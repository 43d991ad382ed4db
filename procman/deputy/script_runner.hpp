#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "procman/config/config.hpp"

namespace curbstone::procman::deputy {

/// Runs one script of a config: actions in order, with waits. check_script() must have found no error in it.
/// Pure: time is an argument, and actions are calls of Callbacks.
class ScriptRunner {
 public:
  struct Callbacks {
    std::function<void(const std::string& id)> start;
    std::function<void(const std::string& id)> stop;
    std::function<void(const std::string& id)> restart;
    /// Whether the command has reached the status: started (or start tried), stopped.
    std::function<bool(const std::string& id, config::WaitStatus)> satisfied;
  };

  ScriptRunner(const config::Config& config, const std::string& script, Callbacks callbacks);

  /// Does what is due at `now` (us, any origin). After a wait for a status the next action follows at least 0.1 s after
  /// the one before, as in procman's sheriff.
  void step(std::int64_t now);
  [[nodiscard]] bool done() const { return next_ == steps_.size(); }

 private:
  struct Step {
    config::ActionKind kind;
    std::vector<std::string> ids;
    config::WaitStatus wait_for;
    std::int64_t wait_us;
  };
  void flatten(const config::Config& config, const config::Script& script);
  void act(const Step& step) const;

  Callbacks callbacks_;
  std::vector<Step> steps_;
  std::size_t next_ = 0;
  bool begun_ = false;         // the next step is a wait that has begun
  std::int64_t since_ = 0;     // us, begin of that wait
  std::int64_t acted_at_ = 0;  // us, of the last action
  bool must_pause_ = false;    // the last step waited for a status
};

}  // namespace curbstone::procman::deputy
