#pragma once

#include <optional>
#include <string>

#include "drivers/encoder/can/can_link.hpp"
#include "drivers/encoder/traces/trace_file.hpp"

namespace curbstone::encoder::traces {

/// Plays a recording: its frames come with the times that were recorded, spaced as they were. Stops the loop at its
/// end. Nothing can be sent.
///
/// Counts: those of TraceFile, dropped.no_bus (frames to send).
class FileLink final : public can::CanLink {
 public:
  /// `rate` times real time; 0: as fast as it can be read. Throws as TraceFile does.
  FileLink(const std::string& path, double rate);

  void attach(EventLoop& loop, Handlers handlers) override;
  void send(const can::CanFrame&) override { counters_.add("dropped.no_bus"); }
  void report(NodeReport& report) const override;

 private:
  void feed();

  TraceFile file_;
  double rate_;
  std::optional<TraceFile::Frame> next_;
  std::int64_t first_utime_ = 0;
  std::int64_t refused_ = 0;
  std::optional<std::int64_t> started_;  // us, steady clock
  EventLoop* loop_ = nullptr;
  Handlers handlers_;
  Counters counters_;
};

}  // namespace curbstone::encoder::traces
