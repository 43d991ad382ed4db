#include "common/bus/socket/route_watch.hpp"

#include <sys/eventfd.h>

#include <chrono>
#include <utility>

namespace curbstone {

RouteWatch::RouteWatch(BusAddress address, int event_fd)
    : address_(std::move(address)), event_fd_(event_fd), thread_([this] { run(); }) {}

RouteWatch::~RouteWatch() {
  {
    const std::scoped_lock lock(mutex_);
    ends_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

void RouteWatch::run() {
  constexpr std::chrono::milliseconds kPeriod{200};
  std::unique_lock lock(mutex_);
  while (!changed_.wait_for(lock, kPeriod, [this] { return ends_; })) {
    if (!route_error(address_)) (void)eventfd_write(event_fd_, 1);
  }
}

}  // namespace curbstone
