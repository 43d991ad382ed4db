#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "services/ekf/model/error_state.hpp"

namespace curbstone::ekf::state {

/// Writes the filter's belief to its state file (state_file.hpp) in a thread of its own: a file system that flushes
/// when a file is replaced (ext4) may block for a second, and odometry must not wait for it. If several beliefs arrive
/// during a write, only the newest is written next; the destructor writes the last one.
class StateKeeper {
 public:
  explicit StateKeeper(std::string path);
  ~StateKeeper();
  StateKeeper(const StateKeeper&) = delete;
  StateKeeper& operator=(const StateKeeper&) = delete;

  /// Queues the belief and returns at once. Callable while the writer works.
  void keep(const model::Belief& belief);
  [[nodiscard]] const std::string& path() const { return path_; }
  /// Number of failed writes.
  [[nodiscard]] int failures() const { return failures_; }
  /// Whether the latest write failed.
  [[nodiscard]] bool failing() const { return failing_; }

 private:
  void write(const std::stop_token& stop);

  const std::string path_;
  std::atomic<int> failures_ = 0;
  std::atomic<bool> failing_ = false;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::optional<model::Belief> newest_;  // not written yet
  std::jthread thread_;                  // declared last: it ends before the members that it uses
};

}  // namespace curbstone::ekf::state
