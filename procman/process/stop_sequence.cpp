#include "procman/process/stop_sequence.hpp"

#include <algorithm>
#include <set>

#include "common/time/microseconds.hpp"

namespace curbstone::procman::process {

namespace {
constexpr std::int64_t kAfterKill = 2'000'000;  // us: SIGKILL takes effect at once, unless a device driver hangs
}

StopSequence::StopSequence(Supervisor& supervisor, std::vector<std::vector<std::string>> stages)
    : supervisor_(supervisor), stages_(std::move(stages)) {
  std::set<std::string> staged;
  for (const auto& stage : stages_) staged.insert(stage.begin(), stage.end());
  std::vector<std::string> others;
  for (const CommandState* state : supervisor_.commands()) {
    if (!staged.contains(state->command.id)) others.push_back(state->command.id);
  }
  if (!others.empty()) stages_.insert(stages_.begin(), others);
  // No command is respawned while the others are stopped.
  for (const CommandState* state : supervisor_.commands()) {
    if (state->pid == 0) supervisor_.set_wanted(state->command.id, false);
  }
}

void StopSequence::begin_stage(std::int64_t now) {
  begun_ = true;
  give_up_at_ = now + kAfterKill;
  for (const std::string& id : stages_[stage_]) {
    const CommandState* state = supervisor_.find(id);
    if (state == nullptr) continue;
    const auto allowed = microseconds(state->command.stop_time_allowed);
    if (state->pid != 0) give_up_at_ = std::max(give_up_at_, now + allowed + kAfterKill);
    supervisor_.stop(id);
  }
}

bool StopSequence::step(std::int64_t now) {
  while (stage_ < stages_.size()) {
    if (!begun_) begin_stage(now);
    std::vector<std::string> running;
    for (const std::string& id : stages_[stage_]) {
      const CommandState* state = supervisor_.find(id);
      if (state != nullptr && state->pid != 0) running.push_back(id);
    }
    if (!running.empty() && now < give_up_at_) return false;
    abandoned_.insert(abandoned_.end(), running.begin(), running.end());
    ++stage_;
    begun_ = false;
  }
  return true;
}

}  // namespace curbstone::procman::process
