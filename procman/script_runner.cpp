#include "procman/script_runner.hpp"

#include <algorithm>

namespace curbstone::procman {

namespace {
constexpr std::int64_t kPause = 100'000;  // us
}

ScriptRunner::ScriptRunner(const Config& config, const std::string& script, Hands hands) : hands_(std::move(hands)) {
  if (const Script* found = config.find_script(script)) flatten(config, *found);
}

void ScriptRunner::flatten(const Config& config, const Script& script) {
  for (const Action& action : script.actions) {
    if (action.kind == ActionKind::kRunScript) {
      if (const Script* called = config.find_script(action.script)) flatten(config, *called);
      continue;
    }
    const auto ids = action.kind == ActionKind::kWaitTime ? std::vector<std::string>{} : config.resolve(action.target);
    if (action.kind != ActionKind::kWaitStatus) {
      steps_.push_back({action.kind, ids, WaitStatus::kNone, action.wait_ms * 1000});
    }
    if (action.wait_for != WaitStatus::kNone) steps_.push_back({ActionKind::kWaitStatus, ids, action.wait_for, 0});
  }
}

void ScriptRunner::act(const Step& step) const {
  const auto& hand = step.kind == ActionKind::kStart  ? hands_.start
                     : step.kind == ActionKind::kStop ? hands_.stop
                                                      : hands_.restart;
  for (const std::string& id : step.ids) hand(id);
}

void ScriptRunner::step(std::int64_t now) {
  while (!done()) {
    const Step& step = steps_[next_];
    if (!begun_) {
      begun_ = true;
      since_ = now;
    }
    if (step.kind == ActionKind::kWaitTime) {
      if (now - since_ < step.wait_us) return;
    } else if (step.kind == ActionKind::kWaitStatus) {
      const bool all = std::all_of(step.ids.begin(), step.ids.end(),
                                   [&](const std::string& id) { return hands_.satisfied(id, step.wait_for); });
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

}  // namespace curbstone::procman
