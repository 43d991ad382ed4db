#include "procman/process/supervisor.hpp"

#include <signal.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <limits>
#include <system_error>

#include "common/time/clock.hpp"
#include "common/time/microseconds.hpp"
#include "procman/process/process_table.hpp"

namespace curbstone::procman::process {

namespace {

constexpr std::size_t kReadAtMost = 65536;  // bytes per wake-up: a child with much output must not starve the others
constexpr std::size_t kDrainAtMost = 16 * 1024 * 1024;  // bytes, when a command has ended
constexpr std::int64_t kLookAgain = 50'000;             // us: while descendants outlive their leader
constexpr std::int64_t kKillAgain = 200'000;            // us: for processes that were forked during the kill
constexpr int kCannotExecute = 127 << 8;                // a shell's status for it, as a raw wait status

FileDescriptor watch_children() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGCHLD);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  FileDescriptor fd(signalfd(-1, &signals, SFD_NONBLOCK | SFD_CLOEXEC));
  if (!fd) throw std::system_error(errno, std::generic_category(), "signalfd");
  return fd;
}

}  // namespace

Supervisor::Supervisor(EventLoop& loop, Events events)
    : loop_(loop), events_(std::move(events)), child_signal_(watch_children()), timer_(loop, [this] { on_timer(); }) {
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  loop_.watch(child_signal_.get(), [this] { reap(); });
}

Supervisor::~Supervisor() {
  kill_all();
  for (auto& [id, managed] : commands_) {
    if (managed->process.pid != 0 && !managed->leader_gone) waitpid(managed->process.pid, nullptr, 0);
    close_terminal(*managed);
    if (managed->end) loop_.unwatch(managed->end.get());
  }
  loop_.unwatch(child_signal_.get());
}

void Supervisor::set(const config::Command& command) {
  auto& managed = commands_[command.id];
  if (!managed) {
    managed = std::make_unique<Managed>();
    managed->mark = new_mark_of(command.id);
  }
  managed->state.command = command;
  managed->remove_at_end = false;
}

void Supervisor::remove(const std::string& id) {
  const auto it = commands_.find(id);
  if (it == commands_.end()) return;
  if (it->second->state.pid == 0) {
    commands_.erase(it);
  } else {
    it->second->remove_at_end = true;
    stop(id);
  }
}

void Supervisor::start(const std::string& id) {
  const auto it = commands_.find(id);
  if (it == commands_.end()) return;
  it->second->state.wanted = true;
  if (it->second->state.pid != 0) return;
  it->second->backoff.reset();
  launch(*it->second);
}

void Supervisor::stop(const std::string& id) {
  const auto it = commands_.find(id);
  if (it == commands_.end()) return;
  Managed& managed = *it->second;
  managed.state.wanted = false;
  managed.state.respawn_at = 0;
  managed.start_at_end = false;
  if (managed.state.pid != 0 && !managed.state.stopping) begin_stop(managed, managed.state.command.stop_time_allowed);
}

void Supervisor::restart(const std::string& id) {
  const auto it = commands_.find(id);
  if (it == commands_.end()) return;
  if (it->second->state.pid == 0) return start(id);
  stop(id);
  it->second->start_at_end = true;
}

void Supervisor::replace(const std::string& id) {
  const auto it = commands_.find(id);
  if (it == commands_.end() || it->second->state.pid == 0 || it->second->state.stopping) return;
  it->second->state.hung = true;
  begin_kill(*it->second);
  it->second->start_at_end = true;
  arm_timer();
}

void Supervisor::set_wanted(const std::string& id, bool wanted) {
  const auto it = commands_.find(id);
  if (it == commands_.end()) return;
  it->second->state.wanted = wanted;
  if (!wanted) it->second->state.respawn_at = 0;
}

void Supervisor::kill_all() {
  for (auto& [id, managed] : commands_) {
    managed->state.wanted = false;
    managed->state.respawn_at = 0;
    managed->start_at_end = false;
    if (managed->state.pid == 0) continue;
    begin_kill(*managed);
  }
  arm_timer();
}

const CommandState* Supervisor::find(const std::string& id) const {
  const auto it = commands_.find(id);
  return it == commands_.end() ? nullptr : &it->second->state;
}

std::vector<const CommandState*> Supervisor::commands() const {
  std::vector<const CommandState*> states;
  for (const auto& [id, managed] : commands_) states.push_back(&managed->state);
  return states;
}

bool Supervisor::any_running() const {
  return std::any_of(commands_.begin(), commands_.end(), [](const auto& item) { return item.second->state.pid != 0; });
}

int Supervisor::terminal(const std::string& id) const {
  const auto it = commands_.find(id);
  return it == commands_.end() ? -1 : it->second->process.terminal.get();
}

std::vector<pid_t> Supervisor::family(const std::string& id) const {
  const auto it = commands_.find(id);
  return it == commands_.end() || it->second->state.pid == 0 ? std::vector<pid_t>() : family(*it->second);
}

void Supervisor::launch(Managed& managed) {
  CommandState& state = managed.state;
  state.respawn_at = 0;
  state.exit_status = 0;
  state.stopping = false;
  state.killed = false;
  state.hung = false;
  state.refused = false;
  state.adopted = false;
  state.started = steady_clock();
  ++state.starts;
  managed.leader_gone = false;
  managed.start_at_end = false;
  managed.end = FileDescriptor();
  managed.reaper = 0;
  managed.mark = new_mark_of(state.command.id);
  const std::string id = state.command.id;
  const config::ExecLine line = config::parse_exec_line(state.command.exec, config::from_environment);
  try {
    if (!line.error.empty()) throw std::runtime_error("exec: " + line.error);
    managed.process = spawn(line, managed.mark);
  } catch (const std::exception& error) {
    events_.output(id, std::string("cannot start: ") + error.what() + "\r\n");
    state.exit_status = kCannotExecute;
    end_life(managed);
    return;
  }
  begin_life(managed);
}

void Supervisor::begin_life(Managed& managed) {
  const std::string id = managed.state.command.id;
  managed.state.pid = managed.process.pid;
  loop_.watch(managed.process.terminal.get(), [this, id] {
    const auto it = commands_.find(id);
    if (it != commands_.end()) read_output(*it->second, kReadAtMost);
  });
  events_.started(managed.state);
}

void Supervisor::begin_stop(Managed& managed, double time_allowed) {
  managed.state.stopping = true;
  managed.kill_at = steady_clock() + microseconds(std::clamp(time_allowed, 0.0, 86400.0));
  signal_family(managed, managed.state.command.stop_signal);
  arm_timer();
}

void Supervisor::begin_kill(Managed& managed) {
  managed.state.stopping = true;
  managed.state.killed = true;
  managed.kill_at = steady_clock() + kKillAgain;
  signal_family(managed, SIGKILL);
}

std::vector<pid_t> Supervisor::family(const Managed& managed) {
  return find_family(read_process_table(), managed.process.pid, managed.mark, managed.reaper);
}

void Supervisor::signal_family(const Managed& managed, int signal) {
  for (const pid_t pid : family(managed)) kill(pid, signal);
}

void Supervisor::read_output(Managed& managed, std::size_t at_most) {
  std::array<char, 16384> buffer;
  for (std::size_t total = 0; total < at_most && managed.process.terminal;) {
    const ssize_t size = read(managed.process.terminal.get(), buffer.data(), buffer.size());
    if (size > 0) {
      total += static_cast<std::size_t>(size);
      events_.output(managed.state.command.id, {buffer.data(), static_cast<std::size_t>(size)});
    } else if (size < 0 && errno == EINTR) {
      continue;
    } else if (size < 0 && errno == EAGAIN) {
      return;
    } else {  // EIO: the other side is closed
      close_terminal(managed);
    }
  }
}

void Supervisor::close_terminal(Managed& managed) {
  if (!managed.process.terminal) return;
  loop_.unwatch(managed.process.terminal.get());
  managed.process.terminal = FileDescriptor();
}

void Supervisor::reap() {
  signalfd_siginfo info{};
  while (read(child_signal_.get(), &info, sizeof info) > 0) {
  }
  int status = 0;
  for (pid_t pid = 0; (pid = waitpid(-1, &status, WNOHANG)) > 0;) {
    for (auto& [id, managed] : commands_) {
      if (managed->process.pid != pid || managed->leader_gone || managed->state.pid == 0) continue;
      managed->leader_gone = true;
      managed->state.exit_status = status;
    }
  }
  std::vector<std::string> ids;
  for (const auto& [id, managed] : commands_) {
    if (managed->state.pid != 0 && managed->leader_gone) ids.push_back(id);
  }
  for (const std::string& id : ids) {
    const auto it = commands_.find(id);
    if (it != commands_.end()) end_if_all_exited(*it->second);
  }
  arm_timer();
}

/// After the first process has ended: the life is over when its descendants have ended too.
void Supervisor::end_if_all_exited(Managed& managed) {
  if (!family(managed).empty()) {
    if (!managed.state.stopping) begin_stop(managed, managed.state.command.stop_time_allowed);
    return;
  }
  read_output(managed, kDrainAtMost);
  close_terminal(managed);
  managed.state.pid = 0;
  end_life(managed);
}

void Supervisor::end_life(Managed& managed) {
  const std::int64_t now = steady_clock();
  const std::int64_t lived = now - managed.state.started;
  const std::string id = managed.state.command.id;
  const int status = managed.state.exit_status;
  managed.state.refused =
      managed.state.command.heartbeat > 0 && WIFEXITED(status) && WEXITSTATUS(status) == kExitConfigError;
  if (managed.state.refused) {
    managed.state.wanted = false;
  } else if (managed.start_at_end) {
    managed.state.wanted = true;
    managed.state.respawn_at = now;
  } else if (managed.state.wanted && managed.state.command.auto_respawn) {
    managed.state.respawn_at = now + managed.backoff.next(lived);
  }
  const bool remove = managed.remove_at_end;
  const CommandState ended = managed.state;
  if (remove) commands_.erase(id);
  arm_timer();
  events_.ended(ended, lived);
}

void Supervisor::on_timer() {
  const std::int64_t now = steady_clock();
  std::vector<std::string> ids;
  for (const auto& [id, managed] : commands_) ids.push_back(id);
  for (const std::string& id : ids) {
    const auto it = commands_.find(id);
    if (it == commands_.end()) continue;
    Managed& managed = *it->second;
    if (managed.state.pid != 0 && managed.state.stopping && now >= managed.kill_at) {
      managed.state.killed = true;
      managed.kill_at = now + kKillAgain;
      signal_family(managed, SIGKILL);
    }
    if (managed.state.pid != 0 && managed.leader_gone) {
      end_if_all_exited(managed);
    } else if (managed.state.pid == 0 && managed.state.respawn_at != 0 && now >= managed.state.respawn_at) {
      launch(managed);
    }
  }
  arm_timer();
}

void Supervisor::arm_timer() {
  constexpr auto kNever = std::numeric_limits<std::int64_t>::max();
  std::int64_t due = kNever;
  for (const auto& [id, managed] : commands_) {
    if (managed->state.pid != 0 && managed->state.stopping) due = std::min(due, managed->kill_at);
    if (managed->state.pid != 0 && managed->leader_gone) due = std::min(due, steady_clock() + kLookAgain);
    if (managed->state.pid == 0 && managed->state.respawn_at != 0) due = std::min(due, managed->state.respawn_at);
  }
  if (due != kNever) timer_.arm(due);
}

}  // namespace curbstone::procman::process
