#include "procman/deputy/alarms.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace curbstone::procman::deputy {

void Alarms::ended(const process::CommandState& state, const std::string& how, std::int64_t now) {
  Past& past = past_[state.command.id];
  past.how = how;
  if (!state.stopping) past.deaths.push_back(now);
}

void Alarms::silent(const std::string& id, double seconds, std::int64_t now) {
  past_[id].silence = {seconds, now};
}

std::vector<std::string> Alarms::faults(const std::vector<const process::CommandState*>& commands, std::int64_t now) {
  std::vector<std::string> lines;
  std::map<std::string, Past> kept;
  for (const process::CommandState* state : commands) {
    const std::string& id = state->command.id;
    const auto it = past_.find(id);
    if (it == past_.end()) continue;
    Past& past = it->second;
    std::erase_if(past.deaths, [&](std::int64_t at) { return now - at > kWindow; });
    if (state->refused)
      lines.push_back(
          fmt::format("{}: wrong configuration or options (exit status {}): not started again until ordered", id,
                      process::kRefuses));
    else if (past.deaths.size() >= kCrashLoop)
      lines.push_back(
          fmt::format("{} keeps dying: {} times in the last minute ({})", id, past.deaths.size(), past.how));
    if (past.silence.at != 0 && now - past.silence.at <= kWindow)
      lines.push_back(fmt::format("{} was silent for {:.0f} s and was replaced", id, past.silence.seconds));
    kept.insert({id, std::move(past)});
  }
  past_ = std::move(kept);
  return lines;
}

}  // namespace curbstone::procman::deputy
