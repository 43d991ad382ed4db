#include "drivers/lidar/sources/pcapng_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string_view>

#include "common/bytes/big_endian.hpp"
#include "common/bytes/little_endian.hpp"

namespace curbstone::lidar::sources {
namespace {

constexpr std::uint32_t kSection = 0x0A0D0D0A;
constexpr std::uint32_t kInterface = 1;
constexpr std::uint32_t kPacket = 2;  // obsolete
constexpr std::uint32_t kSimplePacket = 3;
constexpr std::uint32_t kEnhancedPacket = 6;
constexpr std::uint32_t kMagic = 0x1A2B3C4D;
constexpr std::uint16_t kResolution = 9, kOffset = 14;  // options of an interface
constexpr std::uint32_t kMaxBlock = 16'000'000;         // bytes, as libpcap
constexpr int kMicro = 6;

std::uint64_t power_of_ten(int exponent) {
  std::uint64_t power = 1;
  for (int i = 0; i < exponent; ++i) power *= 10;
  return power;
}

}  // namespace

template <class Number>
Number PcapngReader::number(std::span<const std::uint8_t> bytes) const {
  return is_big_endian_ ? read_big_endian<Number>(bytes) : read_little_endian<Number>(bytes);
}

bool PcapngReader::is_pcapng(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::array<char, 4> type{};
  return in.read(type.data(), type.size()) && std::string_view(type.data(), type.size()) == "\x0A\x0D\x0D\x0A";
}

PcapngReader::PcapngReader(const std::string& file) : file_(file), in_(file, std::ios::binary) {
  if (!in_) throw std::runtime_error(file + ": cannot be read");
  while (read_head() && (head_->type == kSection || head_->type == kInterface)) {
    const std::uint32_t type = head_->type;
    read_body();
    type == kSection ? begin_section() : describe_interface();
  }
}

std::vector<int> PcapngReader::links() const {
  return links_;
}

void PcapngReader::damaged(const std::string& what) const {
  throw std::runtime_error(fmt::format("{}: damaged: {}", file_, what));
}

/// False at the end of the file.
bool PcapngReader::read(std::span<std::uint8_t> bytes) {
  in_.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  const auto got = static_cast<std::size_t>(in_.gcount());
  if (got == bytes.size()) return true;
  if (got > 0) throw std::runtime_error(file_ + ": truncated: it ends within a block");
  return false;
}

/// Reads type and length of the next block, unless that was done. The byte order of a section is that of its magic.
bool PcapngReader::read_head() {
  if (head_) return true;
  std::array<std::uint8_t, 8> head{};
  if (!read(head)) return false;
  const auto type = number<std::uint32_t>(head);
  body_.clear();
  if (type == kSection) {
    body_.resize(4);
    if (!read(body_)) throw std::runtime_error(file_ + ": truncated: it ends within a block");
    is_big_endian_ = read_big_endian<std::uint32_t>(std::span<const std::uint8_t>(body_)) == kMagic;
    if (number<std::uint32_t>(body_) != kMagic) damaged("a section without its magic number");
  }
  const auto length = number<std::uint32_t>(std::span<const std::uint8_t>(head).subspan(4));
  if (length < 12 + body_.size() || length > kMaxBlock) damaged(fmt::format("a block of {} bytes", length));
  head_ = Head{type, (length + 3) / 4 * 4 - 12};
  return true;
}

/// Reads the rest of the block, with the length that follows it.
void PcapngReader::read_body() {
  const std::size_t begin = body_.size();
  const std::size_t length = std::max<std::size_t>(head_->length, begin);
  body_.resize(length + 4);
  head_.reset();
  if (!read(std::span(body_).subspan(begin))) throw std::runtime_error(file_ + ": truncated: it ends within a block");
  body_.resize(length);
}

void PcapngReader::begin_section() {
  interfaces_.clear();
}

void PcapngReader::describe_interface() {
  if (body_.size() < 8) damaged("an interface without a link type");
  const std::span<const std::uint8_t> body(body_);
  Interface interface;
  interface.link = number<std::uint16_t>(body);
  interface.snap_length = number<std::uint32_t>(body.subspan(4));
  for (std::size_t at = 8; at + 4 <= body.size();) {
    const auto code = number<std::uint16_t>(body.subspan(at));
    const std::size_t length = number<std::uint16_t>(body.subspan(at + 2));
    at += 4;
    if (code == 0 || at + length > body.size()) break;
    if (code == kResolution && length == 1) {
      interface.exponent = body[at] & 0x7F;
      interface.is_binary = (body[at] & 0x80) != 0;
    } else if (code == kOffset && length == 8) {
      interface.offset = static_cast<std::int64_t>(number<std::uint64_t>(body.subspan(at)));
    }
    at += (length + 3) / 4 * 4;
  }
  if (interface.exponent > (interface.is_binary ? 63 : 19)) damaged("an interface with an impossible unit of time");
  interfaces_.push_back(interface);
  links_.push_back(interface.link);
}

std::optional<PcapngReader::Frame> PcapngReader::next() {
  while (read_head()) {
    const std::uint32_t type = head_->type;
    read_body();
    const std::span<const std::uint8_t> body(body_);
    const auto word = [&](std::size_t i) { return std::uint64_t{number<std::uint32_t>(body.subspan(4 * i))}; };
    switch (type) {
      case kSection:
        begin_section();
        break;
      case kInterface:
        describe_interface();
        break;
      case kEnhancedPacket:
      case kPacket:
        if (body.size() < 20) damaged("a packet without a head");
        return frame_of(type == kPacket ? number<std::uint16_t>(body) : word(0), word(1) << 32 | word(2), 20, word(3));
      case kSimplePacket: {
        if (body.size() < 4 || interfaces_.empty()) damaged("a packet without a head or an interface");
        const std::uint64_t snap = interfaces_.front().snap_length;
        Frame frame = frame_of(0, 0, 4, std::min(word(0), snap == 0 ? word(0) : snap));
        frame.seconds = frame.microseconds = 0;
        return frame;
      }
      default:
        break;
    }
  }
  return std::nullopt;
}

PcapngReader::Frame PcapngReader::frame_of(std::size_t interface, std::uint64_t stamp, std::size_t at,
                                           std::size_t length) const {
  if (interface >= interfaces_.size())
    damaged(fmt::format("a packet of interface {}, which is not described", interface));
  if (length > body_.size() - at) damaged("a packet longer than its block");
  const Interface& of = interfaces_[interface];
  Frame frame;
  frame.link = of.link;
  frame.bytes = std::span(body_).subspan(at, length);
  const std::uint64_t units = of.is_binary ? std::uint64_t{1} << of.exponent : power_of_ten(of.exponent);
  const std::uint64_t seconds = stamp / units, rest = stamp % units;
  if (of.is_binary)
    frame.microseconds = static_cast<std::int64_t>(std::ldexp(static_cast<double>(rest), -of.exponent) * 1e6);
  else if (of.exponent <= kMicro)
    frame.microseconds = static_cast<std::int64_t>(rest * power_of_ten(kMicro - of.exponent));
  else
    frame.microseconds = static_cast<std::int64_t>(rest / power_of_ten(of.exponent - kMicro));
  constexpr std::uint64_t kMaxTime = std::numeric_limits<std::int64_t>::max() / 4;
  const std::int64_t offset = std::clamp<std::int64_t>(of.offset, -static_cast<std::int64_t>(kMaxTime), kMaxTime);
  frame.seconds = static_cast<std::int64_t>(std::min(seconds, kMaxTime)) + offset;
  return frame;
}

}  // namespace curbstone::lidar::sources
