#include "procman/deputy/script_runner.hpp"

#include <algorithm>

namespace curbstone::procman::deputy {

namespace {
constexpr std::int64_t kPause = 100'000;  // us
}

ScriptRunner::ScriptRunner(const config::Config& config, const std::string& script, Callbacks callbacks)
    : callbacks_(std::move(callbacks)) {
  if (const config::Script* found = config.find_script(script)) flatten(config, *found);
}

void ScriptRunner::flatten(const config::Config& config, const config::Script& script) {
  for (const config::Action& action : script.actions) {
    if (action.kind == config::ActionKind::kRunScript) {
      if (const config::Script* called = config.find_script(action.script)) flatten(config, *called);
      continue;
    }
    const auto ids =
        action.kind == config::ActionKind::kWaitTime ? std::vector<std::string>{} : config.resolve(action.target);
    if (action.kind != config::ActionKind::kWaitStatus) {
      steps_.push_back({action.kind, ids, config::WaitStatus::kNone, action.wait_ms * 1000});
    }
    if (action.wait_for != config::WaitStatus::kNone)
      steps_.push_back({config::ActionKind::kWaitStatus, ids, action.wait_for, 0});
  }
}

void ScriptRunner::act(const Step& step) const {
  const auto& callback = step.kind == config::ActionKind::kStart  ? callbacks_.start
                         : step.kind == config::ActionKind::kStop ? callbacks_.stop
                                                                  : callbacks_.restart;
  for (const std::string& id : step.ids) callback(id);
}

void ScriptRunner::step(std::int64_t now) {
  while (!done()) {
    const Step& step = steps_[next_];
    if (!begun_) {
      begun_ = true;
      since_ = now;
    }
    if (step.kind == config::ActionKind::kWaitTime) {
      if (now - since_ < step.wait_us) return;
    } else if (step.kind == config::ActionKind::kWaitStatus) {
      const bool all = std::all_of(step.ids.begin(), step.ids.end(),
                                   [&](const std::string& id) { return callbacks_.satisfied(id, step.wait_for); });
      if (!all) return;
      must_pause_ = true;
    } else {
      if (must_pause_ && now - acted_at_ < kPause) return;
      must_pause_ = false;
      acted_at_ = now;
      act(step);
    }
    begun_ = false;
    ++next_;
  }
}

}  // namespace curbstone::procman::deputy
