#include "procman/deputy/alarms.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace curbstone::procman::deputy {

void Alarms::ended(const process::CommandState& state, const std::string& how, std::int64_t now) {
  History& history = history_[state.command.id];
  history.how = how;
  if (!state.stopping) history.deaths.push_back(now);
}

void Alarms::silent(const std::string& id, double seconds, std::int64_t now) {
  history_[id].silence = {seconds, now};
}

std::vector<std::string> Alarms::faults(const std::vector<const process::CommandState*>& commands, std::int64_t now) {
  std::vector<std::string> lines;
  std::map<std::string, History> kept;
  for (const process::CommandState* state : commands) {
    const std::string& id = state->command.id;
    const auto it = history_.find(id);
    if (it == history_.end()) continue;
    History& history = it->second;
    std::erase_if(history.deaths, [&](std::int64_t at) { return now - at > kWindow; });
    if (state->refused)
      lines.push_back(
          fmt::format("{}: wrong configuration or options (exit status {}): not started again until ordered", id,
                      process::kExitConfigError));
    else if (history.deaths.size() >= kCrashLoop)
      lines.push_back(
          fmt::format("{} keeps dying: {} times in the last minute ({})", id, history.deaths.size(), history.how));
    if (history.silence.at != 0 && now - history.silence.at <= kWindow)
      lines.push_back(fmt::format("{} was silent for {:.0f} s and was replaced", id, history.silence.seconds));
    kept.insert({id, std::move(history)});
  }
  history_ = std::move(kept);
  return lines;
}

}  // namespace curbstone::procman::deputy
