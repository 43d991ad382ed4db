#pragma once

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "tools/replay/stage_group.hpp"

namespace curbstone::replay {

/// Groups of nodes in a row, each in a thread of its own or all in the caller's. What a group sees is the same row of
/// messages either way, so everything that it says is:
///
/// - Messages go from each group to the next in the order in which they were published, and past those that do not hear
///   them.
/// - The drive is cut into pieces by beats. What a group says to an earlier one (TILE_REQUEST) arrives there kLag beats
///   later, which is after every group has come so far. So no group is more than kLag beats ahead of the last, and what
///   waits between them is bounded.
///
/// A node that throws ends the line: the next call throws the same.
class StageLine {
 public:
  static constexpr std::int64_t kLag = 8;  ///< beats

  struct Options {
    bool threads = true;         ///< a thread for each group
    StageGroup::Out everything;  ///< gets every message, those that come in too, in an order that never changes
  };
  /// The groups must have all their nodes.
  StageLine(std::vector<std::unique_ptr<StageGroup>> groups, Options options);
  ~StageLine();
  StageLine(const StageLine&) = delete;
  StageLine& operator=(const StageLine&) = delete;

  void deliver(std::string channel, std::vector<std::uint8_t> bytes);
  /// A piece is over; `now` us of message time. Waits while the groups are far behind.
  void beat(std::int64_t now, bool ticks);
  /// The drive is over: returns when all groups have finished.
  void finish();

 private:
  struct Place {
    std::unique_ptr<StageGroup> group;
    StageQueue in;
    std::vector<LineItem> out;  // to the next, or to `everything`
    std::int64_t done = -1;     // the last beat that it has come to
    /// By the beat in which it was said, what goes back to each earlier group.
    std::map<std::int64_t, std::vector<std::pair<std::size_t, LineItem>>> back;
    std::thread thread;
  };
  void enter(LineItem item);
  void run(std::size_t at);
  void work(std::size_t at, LineItem item);
  void said(std::size_t at, LineItem message);
  [[nodiscard]] bool is_wanted_after(std::size_t at, const std::string& channel) const;
  /// What later groups said until a beat, once they have all come to it.
  [[nodiscard]] std::vector<LineItem> back_until(std::size_t at, std::int64_t beat);
  void note_done(std::size_t at, std::int64_t beat);
  void flush(std::size_t at);
  void stop();
  void fail(std::exception_ptr error);
  void rethrow();

  Options options_;
  std::vector<std::unique_ptr<Place>> places_;
  std::vector<LineItem> entering_;
  std::int64_t beats_ = 0;
  std::mutex mutex_;  // of done, back, failed_
  std::condition_variable moved_;
  std::exception_ptr failed_;
};

}  // namespace curbstone::replay
