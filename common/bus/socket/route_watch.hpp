#pragma once

#include <condition_variable>
#include <mutex>
#include <thread>

#include "common/bus/socket/bus_address.hpp"

namespace curbstone {

/// Looks for a route to an address, in a thread of its own. While there is one, it makes an eventfd readable five times
/// a second.
class RouteWatch {
 public:
  RouteWatch(BusAddress address, int event_fd);
  ~RouteWatch();
  RouteWatch(const RouteWatch&) = delete;
  RouteWatch& operator=(const RouteWatch&) = delete;

 private:
  void run();
  const BusAddress address_;
  const int event_fd_;
  std::mutex mutex_;  // guards ends_
  std::condition_variable changed_;
  bool ends_ = false;
  std::thread thread_;
};

}  // namespace curbstone
