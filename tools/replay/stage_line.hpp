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

/// A pipeline of groups of nodes, each in its own thread or all in the caller's. A group gets the same sequence of
/// messages either way, so its output is the same too:
///
/// - Messages go from each group to the next in the order in which they were published; groups that do not subscribe to
///   them are skipped.
/// - The drive is cut into pieces by beats. A group's message to an earlier group (TILE_REQUEST) arrives there kLag
///   beats later, after every group has reached that beat. So no group is more than kLag beats ahead of the last one,
///   and the queues between them are bounded.
///
/// A node that throws stops the pipeline: the next call throws the same exception.
class StageLine {
 public:
  static constexpr std::int64_t kLag = 8;  ///< beats

  struct Options {
    bool threads = true;  ///< one thread per group
    /// Gets every message, also the input, in an order independent of threads; `now`: of the beat before, or 0.
    StageGroup::Out everything;
  };
  /// All nodes must have been added to the groups.
  StageLine(std::vector<std::unique_ptr<StageGroup>> groups, Options options);
  ~StageLine();
  StageLine(const StageLine&) = delete;
  StageLine& operator=(const StageLine&) = delete;

  void deliver(std::string channel, std::vector<std::uint8_t> bytes);
  /// Ends a piece; `now`: us of message time. Waits while the groups are far behind.
  void beat(std::int64_t now, bool ticks);
  /// No measurement follows; beats may.
  void end_drive();
  /// Returns when all groups have reached the last beat. Their nodes may be accessed until the next call.
  void wait();
  /// Finishes all pending work. Returns when all groups have done so.
  void finish();
  /// What the groups' buses refused. After finish().
  [[nodiscard]] Counters bus_counters() const;

 private:
  struct Place {
    std::unique_ptr<StageGroup> group;
    StageQueue in;
    std::vector<LineItem> out;  // for the next group, or for `everything`
    std::int64_t done = -1;     // the last beat that it has reached
    /// Messages back to each earlier group, by the beat in which they were published.
    std::map<std::int64_t, std::vector<std::pair<std::size_t, LineItem>>> back;
    std::thread thread;
  };
  void enter(LineItem item);
  void run(std::size_t at);
  void work(std::size_t at, LineItem item);
  void said(std::size_t at, LineItem message);
  [[nodiscard]] bool is_wanted_after(std::size_t at, const std::string& channel) const;
  /// The messages of later groups up to a beat, once all of them have reached it.
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
  std::int64_t last_now_ = 0;  // us, of the last beat that left the line
  std::mutex mutex_;           // of done, back, failed_
  std::condition_variable moved_;
  std::exception_ptr failed_;
};

}  // namespace curbstone::replay
