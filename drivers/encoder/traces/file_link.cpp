#include "drivers/encoder/traces/file_link.hpp"

#include <utility>

#include "common/time/clock.hpp"

namespace curbstone::encoder::traces {

namespace {
constexpr int kMaxAtOnce = 64;  // frames per millisecond: no bus has larger bursts
}

FileLink::FileLink(const std::string& path, double rate, std::vector<std::uint32_t> ours)
    : file_(path, std::move(ours)), pace_(rate), next_(file_.next()) {
  first_utime_ = next_->utime;
}

void FileLink::attach(EventLoop& loop, Handlers handlers) {
  loop_ = &loop;
  handlers_ = std::move(handlers);
  handlers_.on_link(first_utime_, link::LinkState::kUp, "");
  loop.every(std::chrono::milliseconds(1), [this] { feed(); });
}

void FileLink::feed() {
  const std::int64_t now = steady_clock();
  for (int i = 0; i < kMaxAtOnce && next_; ++i) {
    if (!pace_.due(next_->utime, now)) return;
    deliver(*next_);
    const std::int64_t utime = next_->utime;
    next_ = file_.next();
    for (; refused_ < file_.counters()["refused.trace_line"]; ++refused_)
      handlers_.on_refused(utime, "refused.trace_line");
  }
  if (!next_) loop_->stop();
}

void FileLink::deliver(const TraceFile::Frame& frame) {
  if (time_.take(frame.utime)) return handlers_.on_frame(frame.utime, frame.frame);
  counters_.add("refused.trace_time");
  handlers_.on_refused(frame.utime, "refused.trace_time");
}

void FileLink::report(NodeReport& report) const {
  for (const Counters* counters : {&file_.counters(), &counters_}) report.counters.add(*counters);
  if (time_.jumps() > 0) report.counters.set("trace.jumps", time_.jumps());
}

}  // namespace curbstone::encoder::traces
