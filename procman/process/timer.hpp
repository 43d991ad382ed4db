#pragma once

#include <cstdint>
#include <functional>

#include "common/shell/event_loop.hpp"
#include "procman/process/file_descriptor.hpp"

namespace curbstone::procman::process {

/// A one-shot timer in an event loop. Arming it again replaces the earlier time.
class Timer {
 public:
  Timer(EventLoop& loop, std::function<void()> task);
  ~Timer();
  Timer(const Timer&) = delete;
  Timer& operator=(const Timer&) = delete;

  /// `due`: us of steady_clock(); a time in the past is due at once.
  void arm(std::int64_t due);

 private:
  EventLoop& loop_;
  FileDescriptor fd_;
};

}  // namespace curbstone::procman::process
