#include "drivers/imu/witmotion/wit_frame.hpp"

#include <algorithm>
#include <numeric>

#include "common/bytes/little_endian.hpp"

namespace curbstone::imu::witmotion {

namespace {

constexpr std::uint8_t kHeader = 0x55;
constexpr std::uint8_t kFirstId = 0x50, kLastId = 0x5A, kReply = 0x5F;

std::uint8_t sum(std::span<const std::uint8_t> bytes) {
  return std::accumulate(bytes.begin(), bytes.end(), std::uint8_t{0},
                         [](std::uint8_t a, std::uint8_t b) { return static_cast<std::uint8_t>(a + b); });
}

}  // namespace

std::int16_t WitFrame::word(std::size_t i) const {
  return static_cast<std::int16_t>(read_little_endian<std::uint16_t>(data.subspan(2 * i)));
}

std::vector<std::uint8_t> encode_wit(std::uint8_t id, std::span<const std::uint8_t> data) {
  std::vector<std::uint8_t> frame(WitFrame::kSize);
  frame[0] = kHeader;
  frame[1] = id;
  std::ranges::copy(data.first(8), frame.begin() + 2);
  frame.back() = sum(std::span(frame).first(WitFrame::kSize - 1));
  return frame;
}

void WitParser::parse(std::span<const std::uint8_t> bytes, const Handler& handler) {
  while (!bytes.empty()) {  // in pieces, so that the buffer stays small
    const auto piece = bytes.first(std::min<std::size_t>(bytes.size(), 1024));
    buffer_.insert(buffer_.end(), piece.begin(), piece.end());
    bytes = bytes.subspan(piece.size());
    drain(handler);
  }
}

void WitParser::reset() {
  buffer_.clear();
  in_step_ = false;
  gap_ = true;
}

WitParser::Candidate WitParser::examine(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return Candidate::kIncomplete;
  if (bytes[0] != kHeader) return Candidate::kBad;
  if (bytes.size() > 1 && (bytes[1] < kFirstId || bytes[1] > kLastId) && bytes[1] != kReply) return Candidate::kBad;
  if (bytes.size() < WitFrame::kSize) return Candidate::kIncomplete;
  const bool good = sum(bytes.first(WitFrame::kSize - 1)) == bytes[WitFrame::kSize - 1];
  return good ? Candidate::kGood : Candidate::kBad;
}

void WitParser::drain(const Handler& handler) {
  std::span<const std::uint8_t> rest = buffer_;
  while (!rest.empty()) {
    Candidate candidate = examine(rest);
    if (candidate == Candidate::kBad && in_step_) counters_.add("refused.checksum");
    if (candidate == Candidate::kGood && !in_step_) candidate = examine(rest.subspan(WitFrame::kSize));
    if (candidate == Candidate::kIncomplete) break;
    if (candidate == Candidate::kBad) {
      counters_.add("garbage_bytes");
      in_step_ = false;
      gap_ = true;
      rest = rest.subspan(1);
      continue;
    }
    in_step_ = true;
    counters_.add("frames");
    handler({rest[1], rest.subspan(2, 8), gap_});
    gap_ = false;
    rest = rest.subspan(WitFrame::kSize);
  }
  buffer_.erase(buffer_.begin(), buffer_.end() - static_cast<std::ptrdiff_t>(rest.size()));
}

}  // namespace curbstone::imu::witmotion
