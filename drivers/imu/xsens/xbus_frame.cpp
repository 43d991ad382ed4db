#include "drivers/imu/xsens/xbus_frame.hpp"

#include <algorithm>
#include <numeric>

#include "common/bytes/big_endian.hpp"

namespace curbstone::imu::xsens {

namespace {

constexpr std::uint8_t kPreamble = 0xFA;
constexpr std::uint8_t kMaster = 0xFF;
constexpr std::uint8_t kFirstTracker = 0x01;
constexpr std::uint8_t kExtended = 0xFF;

/// Only these two can be longer than a single length byte can express.
bool may_be_extended(std::uint8_t mid) {
  return mid == static_cast<std::uint8_t>(Mid::kMtData2) || mid == static_cast<std::uint8_t>(Mid::kOutputConfiguration);
}

std::uint8_t sum(std::span<const std::uint8_t> bytes) {
  return std::accumulate(bytes.begin(), bytes.end(), std::uint8_t{0},
                         [](std::uint8_t a, std::uint8_t b) { return static_cast<std::uint8_t>(a + b); });
}

}  // namespace

std::vector<std::uint8_t> encode_xbus(Mid mid, std::span<const std::uint8_t> data) {
  std::vector<std::uint8_t> frame;
  frame.reserve(data.size() + 7);
  for (const std::uint8_t byte : {kPreamble, kMaster, static_cast<std::uint8_t>(mid)}) frame.push_back(byte);
  frame.push_back(static_cast<std::uint8_t>(std::min<std::size_t>(data.size(), kExtended)));
  if (data.size() >= kExtended) append_big_endian(frame, static_cast<std::uint16_t>(data.size()));
  frame.insert(frame.end(), data.begin(), data.end());
  frame.push_back(static_cast<std::uint8_t>(-sum(std::span(frame).subspan(1))));
  return frame;
}

void XbusParser::parse(std::int64_t now, std::span<const std::uint8_t> bytes, const Handler& handler) {
  if (waiting_ && now - waiting_since_ > kPatience && !buffer_.empty()) {
    counters_.add("refused.incomplete");
    counters_.add("garbage_bytes");
    buffer_.erase(buffer_.begin());
    waiting_ = false;
    drain(now, handler);
  }
  while (!bytes.empty()) {
    const std::size_t room = std::min(bytes.size(), kMaxFrame - buffer_.size());
    buffer_.insert(buffer_.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(room));
    bytes = bytes.subspan(room);
    drain(now, handler);  // leaves room: complete and refused candidates are removed
  }
}

void XbusParser::drain(std::int64_t now, const Handler& handler) {
  std::size_t begin = 0;
  while (true) {
    const auto found = std::find(buffer_.begin() + static_cast<std::ptrdiff_t>(begin), buffer_.end(), kPreamble);
    const auto next = static_cast<std::size_t>(found - buffer_.begin());
    if (next > begin) counters_.add("garbage_bytes", static_cast<std::int64_t>(next - begin));
    if (next > begin || begin > 0) waiting_ = false;
    begin = next;
    if (begin == buffer_.size()) break;

    XbusFrame frame;
    const Candidate candidate = examine(std::span(buffer_).subspan(begin), frame);
    if (candidate == Candidate::kIncomplete) {
      if (!waiting_) waiting_since_ = now;
      waiting_ = true;
      break;
    }
    if (candidate == Candidate::kComplete) {
      counters_.add("frames");
      handler(frame);
      begin += frame.wire_size;
    } else {
      counters_.add("garbage_bytes");
      ++begin;
    }
  }
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(begin));
}

XbusParser::Candidate XbusParser::examine(std::span<const std::uint8_t> bytes, XbusFrame& frame) {
  const char* cause = nullptr;
  Candidate candidate = look_at(bytes, frame, &cause);
  if (candidate == Candidate::kComplete && swallows_another(bytes, frame.wire_size)) {
    candidate = Candidate::kRefused;
    cause = "refused.overlap";
  }
  if (candidate == Candidate::kRefused) counters_.add(cause);
  return candidate;
}

/// A device sends the same message repeatedly. So this candidate's own header inside it is that of the next frame,
/// whose rest has not arrived yet.
bool XbusParser::swallows_another(std::span<const std::uint8_t> bytes, std::size_t size) {
  constexpr std::size_t kHeader = 4;
  const std::span<const std::uint8_t> inside = bytes.first(size).subspan(kHeader);
  if (bytes.size() > size && bytes[size] == kPreamble) return false;
  const std::span<const std::uint8_t> own = bytes.first(kHeader);
  if (std::search(inside.begin(), inside.end(), own.begin(), own.end()) != inside.end()) return true;
  for (std::size_t i = 1; i < size; ++i) {
    XbusFrame other;
    const char* cause = nullptr;
    if (bytes[i] != kPreamble || look_at(bytes.subspan(i), other, &cause) != Candidate::kComplete) continue;
    if (i + other.wire_size > size) return true;
  }
  return false;
}

XbusParser::Candidate XbusParser::look_at(std::span<const std::uint8_t> bytes, XbusFrame& frame, const char** cause) {
  if (bytes.size() < 4) return Candidate::kIncomplete;
  frame.mid = bytes[2];
  std::size_t header = 4;
  std::size_t length = bytes[3];
  bool plausible = bytes[1] == kMaster || bytes[1] == kFirstTracker;
  if (plausible && length == kExtended) {
    if (bytes.size() < 6) return Candidate::kIncomplete;
    header = 6;
    length = read_big_endian<std::uint16_t>(bytes.subspan(4));
    plausible = may_be_extended(frame.mid) && length >= kExtended && length <= kMaxData;
  }
  if (!plausible) {
    *cause = "refused.header";
    return Candidate::kRefused;
  }
  frame.wire_size = header + length + 1;
  if (bytes.size() < frame.wire_size) return Candidate::kIncomplete;
  if (sum(bytes.subspan(1, frame.wire_size - 1)) != 0) {
    *cause = "refused.checksum";
    return Candidate::kRefused;
  }
  frame.data = bytes.subspan(header, length);
  return Candidate::kComplete;
}

}  // namespace curbstone::imu::xsens
