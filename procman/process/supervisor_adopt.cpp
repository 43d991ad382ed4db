#include "procman/process/supervisor.hpp"

namespace curbstone::procman::process {

void Supervisor::adopt(const std::string& id, AdoptedProcess adopted) {
  const auto it = commands_.find(id);
  if (it == commands_.end() || it->second->state.pid != 0) return;
  Managed& managed = *it->second;
  managed.state.wanted = true;
  managed.state.adopted = true;
  managed.state.respawn_at = 0;
  managed.state.started = adopted.started;
  managed.process = std::move(adopted.process);
  managed.end = std::move(adopted.end);
  managed.mark = std::move(adopted.mark);
  managed.reaper = adopted.reaper;
  loop_.watch(managed.end.get(), [this, id] {
    const auto ended = commands_.find(id);
    if (ended == commands_.end()) return;
    loop_.unwatch(ended->second->end.get());
    ended->second->leader_gone = true;
    end_if_all_exited(*ended->second);
    arm_timer();
  });
  begin_life(managed);
}

}  // namespace curbstone::procman::process
