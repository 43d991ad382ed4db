#include "procman/output/console.hpp"

#include <fmt/format.h>
#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

namespace curbstone::procman::output {

namespace {

constexpr std::chrono::milliseconds kLastWords{1000};

/// A descriptor that nobody can read any more takes everything.
void write_all(int fd, std::string_view text) {
  while (!text.empty()) {
    const ssize_t size = ::write(fd, text.data(), text.size());
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) return;
    text.remove_prefix(static_cast<std::size_t>(size));
  }
}

}  // namespace

/// Shared with the thread, which may outlive the console.
struct Console::State {
  State(int to, std::size_t bytes) : fd(to), most(bytes) {}

  const int fd;
  const std::size_t most;
  std::mutex mutex;
  std::condition_variable changed;
  std::string waiting;
  std::int64_t dropped = 0;
  std::int64_t unsaid = 0;  // of those dropped
  bool is_writing = false;
  bool ends = false;

  void run() {
    std::unique_lock lock(mutex);
    while (true) {
      changed.wait(lock, [this] { return !waiting.empty() || ends; });
      if (waiting.empty()) return;
      const std::string text = std::exchange(waiting, {});
      is_writing = true;
      lock.unlock();
      write_all(fd, text);
      lock.lock();
      is_writing = false;
      changed.notify_all();
    }
  }
};

Console::Console(int fd, std::size_t most) : state_(std::make_shared<State>(fd, most)) {
  sigset_t all, before;  // signals are for the thread that waits for them
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  std::thread([state = state_] { state->run(); }).detach();
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

Console::~Console() {
  std::unique_lock lock(state_->mutex);
  state_->ends = true;
  state_->changed.notify_all();
  state_->changed.wait_for(lock, kLastWords, [this] { return state_->waiting.empty() && !state_->is_writing; });
}

void Console::print(std::string_view line) {
  const std::scoped_lock lock(state_->mutex);
  State& state = *state_;
  if (state.waiting.size() + line.size() + 1 > state.most) {
    ++state.dropped;
    ++state.unsaid;
    return;
  }
  if (state.unsaid > 0)
    state.waiting += fmt::format("({} lines were not printed here)\n", std::exchange(state.unsaid, 0));
  state.waiting += line;
  state.waiting += '\n';
  state.changed.notify_all();
}

std::int64_t Console::dropped() const {
  const std::scoped_lock lock(state_->mutex);
  return state_->dropped;
}

}  // namespace curbstone::procman::output
