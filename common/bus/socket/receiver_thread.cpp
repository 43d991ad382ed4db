#include "common/bus/socket/receiver_thread.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <cstdint>
#include <utility>

#include "common/time/clock.hpp"

namespace curbstone {

ReceiverThread::ReceiverThread(BusSocket& socket, std::chrono::microseconds gather, std::function<bool()> receive)
    : socket_(socket),
      gather_(gather),
      receive_(std::move(receive)),
      stop_fd_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)),
      thread_([this] { run(); }) {}

ReceiverThread::~ReceiverThread() {
  (void)eventfd_write(stop_fd_, 1);
  thread_.join();
  close(stop_fd_);
}

void ReceiverThread::run() {
  constexpr int kLookPeriod = 1000;  // ms, at the route
  pollfd fds[2] = {{socket_.fd(), POLLIN, 0}, {stop_fd_, POLLIN, 0}};
  std::int64_t looked = steady_clock();
  while (true) {
    const int ready = poll(fds, 2, kLookPeriod);
    if (const std::int64_t now = steady_clock(); now - looked > std::int64_t{kLookPeriod} * 1000) {
      looked = now;
      socket_.follow_route();
    }
    if (ready <= 0) continue;
    if (fds[1].revents != 0) return;
    if (receive_()) continue;
    const timespec gather{0, static_cast<long>(gather_.count()) * 1000};
    if (gather_.count() > 0 && ppoll(&fds[1], 1, &gather, nullptr) > 0) return;
  }
}

}  // namespace curbstone
