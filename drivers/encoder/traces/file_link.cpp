#include "drivers/encoder/traces/file_link.hpp"

#include <utility>

#include "common/time/clock.hpp"

namespace curbstone::encoder::traces {

namespace {
constexpr int kMostAtOnce = 64;  // frames a millisecond: nobody sends bursts
}

FileLink::FileLink(const std::string& path, double rate) : file_(path), rate_(rate), next_(file_.next()) {
  first_utime_ = next_->utime;
}

void FileLink::attach(EventLoop& loop, Handlers handlers) {
  loop_ = &loop;
  handlers_ = std::move(handlers);
  handlers_.on_link(first_utime_, true, "");
  loop.every(std::chrono::milliseconds(1), [this] { feed(); });
}

void FileLink::feed() {
  const std::int64_t now = steady_clock();
  if (!started_) started_ = now;
  const double played = static_cast<double>(now - *started_) * rate_;
  for (int i = 0; i < kMostAtOnce && next_; ++i) {
    if (rate_ > 0 && static_cast<double>(next_->utime - first_utime_) > played) return;
    handlers_.on_frame(next_->utime, next_->frame);
    const std::int64_t utime = next_->utime;
    next_ = file_.next();
    for (; refused_ < file_.counters()["refused.trace_line"]; ++refused_)
      handlers_.on_refused(utime, "refused.trace_line");
  }
  if (!next_) loop_->stop();
}

void FileLink::report(NodeReport& report) const {
  for (const Counters* counters : {&file_.counters(), &counters_}) {
    for (const auto& [name, value] : counters->values()) report.counters.add(name, value);
  }
}

}  // namespace curbstone::encoder::traces
