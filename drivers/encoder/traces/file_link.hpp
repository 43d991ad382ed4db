#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/time/replay_pace.hpp"
#include "drivers/encoder/can/can_link.hpp"
#include "drivers/encoder/traces/trace_file.hpp"
#include "drivers/encoder/traces/trace_time.hpp"

namespace curbstone::encoder::traces {

/// Plays a recording with its recorded times and intervals. Stops the loop at its end. Nothing can be sent.
///
/// Counts: those of TraceFile, refused.trace_time (times that go back or leap far ahead), trace.jumps (positions at
/// which the recording continues with other times), dropped.no_bus (frames to send).
class FileLink final : public can::CanLink {
 public:
  /// `rate` times real time; 0: as fast as it can be read. Throws as TraceFile does; `ours` is as there.
  FileLink(const std::string& path, double rate, std::vector<std::uint32_t> ours = {});

  void attach(EventLoop& loop, Handlers handlers) override;
  void send(const can::CanFrame&) override { counters_.add("dropped.no_bus"); }
  void report(NodeReport& report) const override;

 private:
  void feed();
  void deliver(const TraceFile::Frame& frame);

  TraceFile file_;
  ReplayPace pace_;
  TraceTime time_;
  std::optional<TraceFile::Frame> next_;
  std::int64_t first_utime_ = 0;
  std::int64_t refused_ = 0;
  EventLoop* loop_ = nullptr;
  Handlers handlers_;
  Counters counters_;
};

}  // namespace curbstone::encoder::traces
