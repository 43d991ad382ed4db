#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "procman/config/config.hpp"

namespace curbstone::procman::deputy {

/// Runs one script of a config: actions in order, with waits. check_config() must have found no error in the config.
/// Pure: time comes in, and actions go out through Hands.
class ScriptRunner {
 public:
  struct Hands {
    std::function<void(const std::string& id)> start;
    std::function<void(const std::string& id)> stop;
    std::function<void(const std::string& id)> restart;
    /// Has what was asked of the command been done: started (or tried), stopped?
    std::function<bool(const std::string& id, config::WaitStatus)> satisfied;
  };

  ScriptRunner(const config::Config& config, const std::string& script, Hands hands);

  /// Does what is due at `now` (us, any origin). After a wait for a status the next action is 0.1 s later than the one
  /// before, as procman's sheriff has it.
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

  Hands hands_;
  std::vector<Step> steps_;
  std::size_t next_ = 0;
  bool begun_ = false;         // the next step is a wait that has begun
  std::int64_t since_ = 0;     // when it began
  std::int64_t acted_at_ = 0;  // when the last action was done
  bool must_pause_ = false;    // a status was waited for
};

}  // namespace curbstone::procman::deputy
