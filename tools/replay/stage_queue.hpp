#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace curbstone::replay {

/// An item of the pipeline (StageLine), in order.
struct LineItem {
  enum class Kind {
    kMessage,
    kBeat,        ///< end of a piece of the drive
    kEndOfDrive,  ///< no measurement follows
    kEnd,         ///< nothing follows
  };
  Kind kind = Kind::kMessage;
  std::string channel;              ///< of a message
  std::vector<std::uint8_t> bytes;  ///< of a message, as encoded
  std::int64_t number = 0;          ///< of a beat, from 0
  std::int64_t now = 0;             ///< us of message time, of a beat; 0 of a message
  bool ticks = false;               ///< a beat at which message time has gone on; else only the piece became long
};

/// A queue from one thread to the next. It needs no bound of its own: StageLine limits how many beats a group can be
/// ahead of the slowest.
class StageQueue {
 public:
  void push(std::vector<LineItem> items) {
    {
      const std::lock_guard lock(mutex_);
      for (LineItem& item : items) items_.push_back(std::move(item));
    }
    some_.notify_one();
  }
  /// Takes all items; waits for some. Empty: closed.
  [[nodiscard]] std::vector<LineItem> take() {
    std::unique_lock lock(mutex_);
    some_.wait(lock, [&] { return !items_.empty() || closed_; });
    if (closed_) return {};
    return std::exchange(items_, {});
  }
  /// Closes the queue: no more items are taken, and queued ones are discarded.
  void close() {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    some_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable some_;
  std::vector<LineItem> items_;
  bool closed_ = false;
};

}  // namespace curbstone::replay
