#include "common/shell/event_loop.hpp"

#include <poll.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "common/time/clock.hpp"

namespace curbstone {

EventLoop::EventLoop() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  sigprocmask(SIG_BLOCK, &signals, nullptr);
  signal(SIGPIPE, SIG_IGN);
  signal_fd_ = signalfd(-1, &signals, SFD_NONBLOCK | SFD_CLOEXEC);
  if (signal_fd_ < 0) throw std::system_error(errno, std::generic_category(), "signalfd");
}

EventLoop::~EventLoop() {
  close(signal_fd_);
}

void EventLoop::watch(int fd, std::function<void()> on_readable) {
  watches_.push_back({fd, POLLIN, std::move(on_readable)});
}

void EventLoop::watch_writable(int fd, std::function<void()> on_writable) {
  watches_.push_back({fd, POLLOUT, std::move(on_writable)});
}

void EventLoop::unwatch(int fd, short events) {
  std::erase_if(watches_, [=](const Watch& watch) { return watch.fd == fd && (watch.events & events) != 0; });
}

void EventLoop::unwatch_writable(int fd) {
  unwatch(fd, POLLOUT);
}

void EventLoop::unwatch(int fd) {
  unwatch(fd, POLLIN | POLLOUT);
}

void EventLoop::every(std::chrono::milliseconds period, std::function<void()> task) {
  const std::int64_t period_us = std::chrono::microseconds(period).count();
  timers_.push_back({period_us, steady_clock() + period_us, std::move(task)});
}

void EventLoop::run() {
  running_ = true;
  bool has_idle_work = idle_ != nullptr;
  std::vector<pollfd> fds;
  while (running_) {
    const std::int64_t gathers_for = has_idle_work ? 0 : gather_until_ - steady_clock();
    fds.assign(1, {signal_fd_, POLLIN, 0});
    if (gathers_for <= 0) {
      for (const Watch& watch : watches_) fds.push_back({watch.fd, watch.events, 0});
    }
    std::int64_t longest_us = has_idle_work ? 0 : until_next_timer();
    if (gathers_for > 0) longest_us = std::min(longest_us, gathers_for);
    const timespec longest{longest_us / 1'000'000, longest_us % 1'000'000 * 1000};
    if (ppoll(fds.data(), fds.size(), &longest, nullptr) < 0 && errno != EINTR) {
      throw std::system_error(errno, std::generic_category(), "poll");
    }
    if (fds[0].revents != 0) return take_signal();
    bool something_happened = false;
    for (std::size_t i = 1; i < fds.size(); ++i) {
      if (fds[i].revents == 0) continue;
      something_happened = true;
      call_handler(fds[i].fd, fds[i].events);
    }
    if (something_happened) gather_until_ = steady_clock() + gather_.count();
    if (run_due_timers()) something_happened = true;
    if (something_happened) has_idle_work = idle_ != nullptr;
    // Descriptors come first. Where they are gathered they are not looked at for a while, so idle work goes on at once.
    const bool is_idle = !something_happened || gather_.count() > 0;
    if (has_idle_work && is_idle) has_idle_work = idle_();
  }
}

/// Time until the next timer, us, at most a second.
std::int64_t EventLoop::until_next_timer() const {
  std::int64_t due = steady_clock() + 1'000'000;
  for (const Timer& timer : timers_) due = std::min(due, timer.due_us);
  return std::max<std::int64_t>(0, due - steady_clock());
}

/// Consumes the signal, so that a second run() waits for another one.
void EventLoop::take_signal() const {
  signalfd_siginfo taken{};
  (void)!read(signal_fd_, &taken, sizeof taken);
}

/// Calls a copy of the handler, looked up anew: a handler may watch and unwatch.
void EventLoop::call_handler(int fd, short events) {
  const auto it = std::find_if(watches_.begin(), watches_.end(),
                               [&](const Watch& watch) { return watch.fd == fd && watch.events == events; });
  if (it == watches_.end()) return;
  const auto handler = it->handler;
  handler();
}

/// Iterates by index, because a task may add a timer. Returns whether any timer was due.
bool EventLoop::run_due_timers() {
  bool was_due = false;
  const std::int64_t now = steady_clock();
  for (std::size_t i = 0; i < timers_.size(); ++i) {
    if (timers_[i].due_us > now) continue;
    was_due = true;
    timers_[i].due_us = std::max(timers_[i].due_us + timers_[i].period_us, now);  // one late call, not a burst
    const auto task = timers_[i].task;
    task();
  }
  return was_due;
}

}  // namespace curbstone
