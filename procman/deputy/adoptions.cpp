#include "procman/deputy/adoptions.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <set>

#include "procman/process/adoption.hpp"
#include "procman/process/process_table.hpp"

namespace curbstone::procman::deputy {

namespace {

constexpr int kLooks = 100;
constexpr useconds_t kBetweenLooks = 10'000;  // us

/// Kills what an earlier deputy left behind and was not adopted, and waits until it is gone: two of a kind would both
/// speak on the bus. Returns the number of the processes.
std::size_t kill_leftovers(const process::Supervisor& supervisor) {
  std::set<pid_t> killed;
  for (int i = 0; i < kLooks; ++i) {
    std::vector<pid_t> left = process::find_leftovers();
    for (const process::CommandState* state : supervisor.commands()) {  // looked at later: what it forks is of it
      for (const pid_t pid : supervisor.family(state->command.id)) std::erase(left, pid);
    }
    if (left.empty()) break;
    for (const pid_t pid : left) kill(pid, SIGKILL);
    killed.insert(left.begin(), left.end());
    usleep(kBetweenLooks);
  }
  return killed.size();
}

}  // namespace

void Adoptions::adopt(const config::Config& config, process::Supervisor& supervisor, const Callbacks& callbacks) {
  for (KeptDescriptor& kept : kept_) {
    const auto running = process::parse_running_command(kept.name);
    const auto command = std::find_if(config.commands.begin(), config.commands.end(), [&](const auto& candidate) {
      return running && process::digest_of(candidate) == running->digest;
    });
    auto adopted = command == config.commands.end() ? std::nullopt : process::recognise(*running, kept.fd);
    if (!adopted) {
      forget_descriptor(kept.name);
      continue;
    }
    callbacks.adopted(command->id, running->run_id);
    supervisor.adopt(command->id, std::move(*adopted));
  }
  const std::size_t killed = is_systemd_service() ? kill_leftovers(supervisor) : 0;
  kept_.clear();
  if (killed == 0) return;
  callbacks.log(fmt::format("{} of an earlier deputy, no command of this one: killed",
                            killed == 1 ? "1 process" : fmt::format("{} processes", killed)));
}

void Adoptions::started(const process::CommandState& state, std::int32_t run_id, int terminal) {
  const auto process = process::read_process(state.pid);
  if (!process || !is_systemd_service()) return;
  const std::string name = process::to_text({.pid = state.pid,
                                             .start_ticks = process->start_ticks,
                                             .run_id = run_id,
                                             .digest = process::digest_of(state.command)});
  names_[state.command.id] = name;
  keep_descriptor(name, terminal);
}

void Adoptions::ended(const std::string& id) {
  const auto it = names_.find(id);
  if (it == names_.end()) return;
  forget_descriptor(it->second);
  names_.erase(it);
}

}  // namespace curbstone::procman::deputy
