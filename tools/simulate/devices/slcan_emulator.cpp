#include "tools/simulate/devices/slcan_emulator.hpp"

#include "drivers/encoder/can/slcan.hpp"

namespace curbstone::simulate::devices {

namespace {
constexpr std::uint8_t kOk = '\r';
constexpr std::uint8_t kRefused = 0x07;
constexpr std::size_t kMaxLine = 64;
}  // namespace

SlcanEmulator::Result SlcanEmulator::on_bytes(std::span<const std::uint8_t> bytes) {
  Result result;
  for (const std::uint8_t byte : bytes) {
    if (byte == '\r') {
      on_line(result);
      line_.clear();
    } else if (line_.size() < kMaxLine) {
      line_.push_back(static_cast<char>(byte));
    }
  }
  return result;
}

void SlcanEmulator::on_line(Result& result) {
  const auto answer = [&](bool accepted) { result.to_host.push_back(accepted ? kOk : kRefused); };
  if (line_.empty()) return answer(true);
  switch (line_[0]) {
    case 'S':
      has_speed_ = has_speed_ || !open_;
      return answer(!open_ && line_.size() == 2 && line_[1] >= '0' && line_[1] <= '8');
    case 'O':
      if (!has_speed_ || open_) return answer(false);
      open_ = true;
      return answer(true);
    case 'C':
      answer(open_);
      open_ = false;
      return;
    case 'F': {
      if (!open_) return answer(false);
      static constexpr char kDigits[] = "0123456789ABCDEF";
      result.to_host.push_back('F');
      result.to_host.push_back(static_cast<std::uint8_t>(kDigits[flags_ >> 4]));
      result.to_host.push_back(static_cast<std::uint8_t>(kDigits[flags_ & 0x0F]));
      flags_ = 0;
      return answer(true);
    }
    case 't':
    case 'T':
    case 'r':
    case 'R': {
      const auto frame = encoder::can::parse_slcan_frame(line_);
      if (!open_ || !frame) return answer(false);
      result.to_bus.push_back(*frame);
      result.to_host.push_back(frame->extended ? 'Z' : 'z');
      return answer(true);
    }
    default:
      return answer(false);
  }
}

std::vector<std::uint8_t> SlcanEmulator::on_frame(const encoder::can::CanFrame& frame) const {
  return open_ ? encoder::can::encode_slcan(frame) : std::vector<std::uint8_t>{};
}

}  // namespace curbstone::simulate::devices
