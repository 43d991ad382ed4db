#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace curbstone {

/// The loop of every process: one thread waits for file descriptors and timers, and calls their handlers. SIGINT and
/// SIGTERM end it.
class EventLoop {
 public:
  /// Blocks SIGINT and SIGTERM for the process, receives them through a signalfd, and ignores SIGPIPE. Create it before
  /// any thread.
  EventLoop();
  ~EventLoop();
  EventLoop(const EventLoop&) = delete;
  EventLoop& operator=(const EventLoop&) = delete;

  /// Calls `on_readable` whenever `fd` is readable, at end of file, or in error. The caller still owns the fd.
  void watch(int fd, std::function<void()> on_readable);
  /// Calls `on_writable` whenever `fd` accepts more bytes, or is in error. End it with unwatch() as soon as no data is
  /// waiting, because most fds are always writable.
  void watch_writable(int fd, std::function<void()> on_writable);
  void unwatch_writable(int fd);
  /// Ends both kinds of watch.
  void unwatch(int fd);
  /// Calls `task` once a period. Missed periods are not made up for.
  void every(std::chrono::milliseconds period, std::function<void()> task);
  /// Calls `task` while nothing is readable and no timer is due, until it returns false. It is called again after the
  /// next event.
  void when_idle(std::function<bool()> task) { idle_ = std::move(task); }

  /// Once something was readable and idle work is done, file descriptors are looked at again only after this time: what
  /// comes at a high rate is handled several at a time. Timers and signals do not wait. 0, the default: not at all.
  void gather(std::chrono::microseconds time) { gather_ = time; }

  /// Runs until stop() or a signal.
  void run();
  void stop() { running_ = false; }

 private:
  struct Watch {
    int fd;
    short events;  // POLLIN or POLLOUT
    std::function<void()> handler;
  };
  void unwatch(int fd, short events);
  [[nodiscard]] std::int64_t until_next_timer() const;
  void take_signal() const;
  void call_handler(int fd, short events);
  bool run_due_timers();
  struct Timer {
    std::int64_t period_us;
    std::int64_t due_us;
    std::function<void()> task;
  };
  std::vector<Watch> watches_;
  std::vector<Timer> timers_;
  std::function<bool()> idle_;
  std::chrono::microseconds gather_{0};
  std::int64_t gather_until_ = 0;  // us, steady
  int signal_fd_ = -1;
  bool running_ = false;
};

}  // namespace curbstone
