#include "drivers/encoder/traces/trace_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>
#include <vector>

#include "drivers/encoder/can/candump.hpp"
#include "drivers/encoder/traces/foreign_recording.hpp"

namespace curbstone::encoder::traces {

namespace {

constexpr std::size_t kHeading = 1000;  // lines
constexpr std::size_t kMaxLine = 512;   // characters
constexpr std::size_t kMaxQuote = 60;   // characters

/// A line as an error message quotes it.
std::string quoted(std::string_view line) {
  std::string text(line.substr(0, std::min(line.find_last_not_of(" \t\r") + 1, kMaxQuote)));
  for (char& c : text) {
    if (c < ' ' || c > '~') c = c == '\t' ? ' ' : '?';
  }
  return text;
}

/// Whether a PCAN trace says so, or begins as one of version 1.0, which says nothing: "     1)      1841  0001  8".
bool is_pcan(const std::deque<std::string>& lines) {
  for (const std::string& line : lines) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string::npos) continue;
    const std::string_view text = std::string_view(line).substr(begin);
    if (text.starts_with(";$FILEVERSION")) return true;
    if (text[0] == ';') continue;
    const std::size_t digits = text.find_first_not_of("0123456789");
    return digits != 0 && digits != std::string_view::npos && text[digits] == ')';
  }
  return false;
}

/// The time that a quarter of these are below.
std::int64_t lower_quartile(std::vector<std::int64_t> times) {
  const auto quarter = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 4);
  std::nth_element(times.begin(), quarter, times.end());
  return *quarter;
}

/// Whether the times are the intervals between frames: those of candump -td often go back, and do not grow. Those of
/// two joined recordings (-tz) go back once.
bool are_intervals(const std::deque<std::string>& lines) {
  constexpr std::int64_t kFirstDate = 100'000'000'000'000;  // us: no clock is in the year 1973
  constexpr std::size_t kEnough = 5;
  std::vector<std::int64_t> times;
  std::size_t back = 0;
  for (const std::string& text : lines) {
    const auto line = can::parse_candump_line(text);
    if (!line || line->utime >= kFirstDate) continue;
    if (!times.empty() && line->utime < times.back()) ++back;
    times.push_back(line->utime);
  }
  if (times.size() < kEnough || 20 * back < times.size()) return false;
  const auto half = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
  std::vector<std::int64_t> first(times.begin(), half);
  for (std::int64_t& time : first) time = -time;
  return -lower_quartile(std::move(first)) >= lower_quartile({half, times.end()});
}

}  // namespace

TraceFile::TraceFile(std::string path, std::vector<std::uint32_t> ours)
    : path_(std::move(path)), file_(path_, std::ios::binary), ours_(std::move(ours)) {
  if (!file_) fail(std::strerror(errno));
  std::string text;
  while (heading_.size() < kHeading && read_from_file(text)) heading_.push_back(text);
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (!heading_.empty() && heading_[0].starts_with(kByteOrderMark)) heading_[0].erase(0, kByteOrderMark.size());
  pcan_ = is_pcan(heading_);
  if (!pcan_) {
    for (const std::string& line : heading_) {
      if (const std::string kind = foreign_recording(line); !kind.empty()) fail(kind);
    }
  }
  if (!pcan_ && are_intervals(heading_))
    fail("its times are the intervals between frames (candump -td); record with candump -l, -ta or -tz");
  const auto refused = [this] { return static_cast<std::size_t>(counters_["refused.trace_line"]); };
  while (!first_ && refused() < kHeading && read_line(text)) {
    const bool none = refused() == 0;
    first_ = parse(text);
    if (!trace_.foreign_version().empty()) {
      fail(fmt::format("a PCAN trace of version {}; 1.0 to 1.3, 2.0, 2.1 and 3.0 can be read",
                       trace_.foreign_version()));
    }
    if (!pcan_ && can::is_candump_without_time(text))
      fail(fmt::format("line {} has no time; record with candump -l, -ta or -tz", line_));
    if (none && refused() > 0) first_refused_ = fmt::format("; line {}: \"{}\"", line_, quoted(text));
  }
  if (!first_ && counters_["ignored.trace_line"] > 0) fail("no classical CAN frames, only CAN FD, errors or events");
  if (!first_ && pcan_) fail(fmt::format("a PCAN trace without CAN frames{}", first_refused_));
  if (!first_) fail(fmt::format("no CAN frames: neither a candump log nor a PCAN trace{}", first_refused_));
}

void TraceFile::fail(const std::string& why) const {
  throw std::runtime_error(fmt::format("{}: {}", path_, why));
}

/// A line that is too long is cut, and refused later: no file can fill the memory.
bool TraceFile::read_from_file(std::string& text) {
  text.clear();
  for (int c = file_.get(); c != EOF; c = file_.get()) {
    if (c == '\n') return true;
    if (text.size() < kMaxLine) text.push_back(static_cast<char>(c));
  }
  return !text.empty();
}

bool TraceFile::read_line(std::string& text) {
  ++line_;
  if (heading_.empty()) return read_from_file(text);
  text = std::move(heading_.front());
  heading_.pop_front();
  return true;
}

std::optional<TraceFile::Frame> TraceFile::parse(const std::string& text) {
  Frame frame;
  std::string bus;
  if (pcan_) {
    const PcanTrace::Line line = trace_.parse(text);
    if (line.kind == PcanTrace::Line::Kind::kRefused) counters_.add("refused.trace_line");
    if (line.kind == PcanTrace::Line::Kind::kOther) counters_.add("ignored.trace_line");
    if (line.kind != PcanTrace::Line::Kind::kFrame) return {};
    frame = {line.utime, line.frame};
    bus = line.bus;
  } else {
    const auto line = can::parse_candump_line(text);
    if (!line && text.find_first_not_of(" \t\r") != std::string::npos) counters_.add("refused.trace_line");
    if (line && line->other) counters_.add("ignored.trace_line");
    if (!line || line->other) return {};
    frame = {line->utime, line->frame};
    bus = line->interface;
  }
  if (!bus_ && is_ours(frame.frame)) bus_ = bus;
  if (bus_ && bus != *bus_) {
    counters_.add("ignored.other_bus");
    return {};
  }
  return frame;
}

bool TraceFile::is_ours(const can::CanFrame& frame) const {
  const std::uint32_t id = frame.id | (frame.extended ? 0x8000'0000u : 0u);
  return ours_.empty() || std::ranges::find(ours_, id) != ours_.end();
}

std::optional<TraceFile::Frame> TraceFile::next() {
  if (first_) return std::exchange(first_, std::nullopt);
  for (std::string text; read_line(text);) {
    if (const auto frame = parse(text)) return frame;
  }
  return {};
}

}  // namespace curbstone::encoder::traces
