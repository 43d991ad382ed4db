#include "drivers/encoder/can/slcan.hpp"

#include <fmt/format.h>

#include <array>

#include "drivers/encoder/can/hex.hpp"

namespace curbstone::encoder::can {

namespace {

constexpr std::uint8_t kCarriageReturn = '\r';
constexpr std::uint8_t kBell = 0x07;
constexpr std::size_t kTimestampDigits = 4;

void append(std::vector<std::uint8_t>& bytes, std::string_view text) {
  bytes.insert(bytes.end(), text.begin(), text.end());
}

}  // namespace

std::optional<CanFrame> parse_slcan_frame(std::string_view line) {
  if (line.empty() || std::string_view("tTrR").find(line[0]) == std::string_view::npos) return {};
  CanFrame frame;
  frame.extended = line[0] == 'T' || line[0] == 'R';
  frame.remote = line[0] == 'r' || line[0] == 'R';
  const std::size_t id_digits = frame.extended ? 8 : 3;
  if (line.size() < 1 + id_digits + 1) return {};
  const auto id = parse_hex(line.substr(1, id_digits));
  const auto size = parse_hex(line.substr(1 + id_digits, 1));
  if (!id || !size || *size > 8 || *id > (frame.extended ? kMaxExtendedId : kMaxStandardId)) return {};
  frame.id = *id;
  frame.size = static_cast<std::uint8_t>(*size);
  line.remove_prefix(1 + id_digits + 1);
  const std::size_t digits = frame.bytes().size() * 2;
  if (line.size() != digits && line.size() != digits + kTimestampDigits) return {};
  if (!parse_hex_bytes(line.substr(0, digits), frame.data)) return {};
  if (line.size() > digits && !parse_hex(line.substr(digits))) return {};
  return frame;
}

bool is_slcan_fd(std::string_view line) {
  static constexpr std::array<std::size_t, 16> kSizes = {0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64};
  if (line.empty() || std::string_view("dDbB").find(line[0]) == std::string_view::npos) return false;
  const bool extended = line[0] == 'D' || line[0] == 'B';
  const std::size_t id_digits = extended ? 8 : 3;
  if (line.size() < 1 + id_digits + 1) return false;
  const auto id = parse_hex(line.substr(1, id_digits));
  const auto code = parse_hex(line.substr(1 + id_digits, 1));
  if (!id || !code || *id > (extended ? kMaxExtendedId : kMaxStandardId)) return false;
  line.remove_prefix(1 + id_digits + 1);
  const std::size_t digits = 2 * kSizes[*code];
  std::array<std::uint8_t, 64 + kTimestampDigits / 2> data;
  return (line.size() == digits || line.size() == digits + kTimestampDigits) && parse_hex_bytes(line, data);
}

std::vector<std::uint8_t> encode_slcan(const CanFrame& frame) {
  const char kind = frame.extended ? (frame.remote ? 'R' : 'T') : (frame.remote ? 'r' : 't');
  std::vector<std::uint8_t> line;
  append(line, frame.extended ? fmt::format("{}{:08X}{}", kind, frame.id, frame.size)
                              : fmt::format("{}{:03X}{}", kind, frame.id, frame.size));
  for (const std::uint8_t byte : frame.bytes()) append(line, fmt::format("{:02X}", byte));
  line.push_back(kCarriageReturn);
  return line;
}

void SlcanParser::parse(std::span<const std::uint8_t> bytes, const Handlers& handlers) {
  for (const std::uint8_t byte : bytes) {
    if (byte == kCarriageReturn) {
      on_line(handlers);
      line_.clear();
      overlong_ = false;
    } else if (byte == kBell) {
      line_.clear();
      overlong_ = false;
      if (handlers.on_answer) handlers.on_answer(Answer::kRefused);
    } else {
      if (line_.size() == kMaxLine) {  // no frame is half as long: the end of the line may still be one
        line_.erase(0, kMaxLine / 2);
        overlong_ = true;
      }
      line_.push_back(static_cast<char>(byte));
    }
  }
}

void SlcanParser::on_line(const Handlers& handlers) {
  // "z" and "Z" confirm that a frame was sent; V and N answer requests that this program does not send.
  if (line_.empty() || line_ == "z" || line_ == "Z") {
    if (handlers.on_answer) handlers.on_answer(Answer::kOk);
    return;
  }
  if (line_[0] == 'F') {
    const auto flags = line_.size() == 3 ? parse_hex(std::string_view(line_).substr(1)) : std::nullopt;
    if (flags && handlers.on_flags) handlers.on_flags(static_cast<std::uint8_t>(*flags));
    if (flags) return;
  }
  if (line_[0] == 'V' || line_[0] == 'N') return;
  if (!overlong_ && is_slcan_fd(line_)) return counters_.add("ignored.slcan_fd");
  auto frame = parse_slcan_frame(line_);
  if (overlong_ || !frame) {
    const char* cause = overlong_ ? "refused.slcan_overlong" : "refused.slcan_line";
    counters_.add(cause);
    if (handlers.on_refused) handlers.on_refused(cause);
    const std::size_t last = line_.find_last_of("tTrR");
    frame = last != std::string::npos ? parse_slcan_frame(std::string_view(line_).substr(last)) : std::nullopt;
  }
  if (!frame) return;
  counters_.add("slcan.frames");
  if (handlers.on_frame) handlers.on_frame(*frame);
}

}  // namespace curbstone::encoder::can
