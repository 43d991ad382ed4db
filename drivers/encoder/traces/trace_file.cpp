#include "drivers/encoder/traces/trace_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "drivers/encoder/can/candump.hpp"

namespace curbstone::encoder::traces {

namespace {
constexpr int kHeading = 1000;             // lines
constexpr std::size_t kLongestLine = 512;  // characters
}  // namespace

TraceFile::TraceFile(std::string path, std::vector<std::uint32_t> ours)
    : path_(std::move(path)), file_(path_, std::ios::binary), ours_(std::move(ours)) {
  const auto fail = [this](const std::string& why) { throw std::runtime_error(fmt::format("{}: {}", path_, why)); };
  if (!file_) fail(std::strerror(errno));
  std::string text;
  for (int i = 0; i < kHeading && !first_ && read_line(text); ++i) {
    pcan_ |= text.starts_with(";$FILEVERSION");
    first_ = parse(text);
    if (!trace_.foreign_version().empty())
      fail(fmt::format("a PCAN trace of version {}; 1.1, 2.0 and 2.1 can be read", trace_.foreign_version()));
  }
  if (!first_) fail("no CAN frames: neither a candump log nor a PCAN trace");
}

/// A line that is too long is cut, and refused later: no file can fill the memory.
bool TraceFile::read_line(std::string& text) {
  text.clear();
  for (int c = file_.get(); c != EOF; c = file_.get()) {
    if (c == '\n') return true;
    if (text.size() < kLongestLine) text.push_back(static_cast<char>(c));
  }
  return !text.empty();
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
