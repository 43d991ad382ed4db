#pragma once

#include <chrono>
#include <functional>
#include <thread>

#include "common/bus/socket/bus_socket.hpp"

namespace curbstone {

/// A thread that receives from a socket until it is destroyed, and has it follow its route.
class ReceiverThread {
 public:
  /// Calls `receive` when datagrams have arrived; it returns whether more may have. After one that does not, those of
  /// the next `gather` are left to arrive together.
  ReceiverThread(BusSocket& socket, std::chrono::microseconds gather, std::function<bool()> receive);
  ~ReceiverThread();
  ReceiverThread(const ReceiverThread&) = delete;
  ReceiverThread& operator=(const ReceiverThread&) = delete;

 private:
  void run();
  BusSocket& socket_;
  const std::chrono::microseconds gather_;
  const std::function<bool()> receive_;
  const int stop_fd_;
  std::thread thread_;
};

}  // namespace curbstone
