#include "tools/simulate/devices/modbus_drive_emulator.hpp"

#include <utility>

namespace curbstone::simulate::devices {

namespace {

constexpr std::size_t kRequestSize = 8;  // slave, function, address, count, checksum
constexpr std::uint8_t kReadHoldingRegisters = 0x03;
constexpr std::uint8_t kError = 0x80;
constexpr std::uint8_t kIllegalFunction = 1;
constexpr std::uint8_t kIllegalAddress = 2;
constexpr std::uint8_t kIllegalValue = 3;
constexpr int kMaxRegisters = 125;

int word(std::span<const std::uint8_t> bytes, std::size_t at) {
  return bytes[at] << 8 | bytes[at + 1];
}

std::uint16_t half(std::int32_t value, bool high) {
  return static_cast<std::uint16_t>(static_cast<std::uint32_t>(value) >> (high ? 16 : 0));
}

}  // namespace

std::uint16_t modbus_crc(std::span<const std::uint8_t> bytes) {
  constexpr unsigned kPolynomial = 0xA001;  // reflected
  unsigned crc = 0xFFFF;
  for (const std::uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1) != 0 ? crc >> 1 ^ kPolynomial : crc >> 1;
  }
  return static_cast<std::uint16_t>(crc);
}

/// Resynchronises after damaged bytes: a request is any eight bytes with the right checksum.
bool ModbusDriveEmulator::on_bytes(std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    if (request_.size() == kRequestSize) request_.erase(request_.begin());
    request_.push_back(byte);
    if (request_.size() < kRequestSize) continue;
    const unsigned sum = request_[6] | static_cast<unsigned>(request_[7]) << 8;
    if (request_[0] == slave_ && modbus_crc(std::span(request_).first(6)) == sum) return true;
  }
  return false;
}

std::vector<std::uint8_t> ModbusDriveEmulator::answer() {
  const std::vector<std::uint8_t> request = std::exchange(request_, {});
  if (request.size() != kRequestSize) return {};
  std::vector<std::uint8_t> reply = {slave_, request[1]};
  const int address = word(request, 2);
  const int count = word(request, 4);
  std::uint8_t exception = 0;
  if (request[1] != kReadHoldingRegisters) {
    exception = kIllegalFunction;
  } else if (count < 1 || count > kMaxRegisters) {
    exception = kIllegalValue;
  } else {
    reply.push_back(static_cast<std::uint8_t>(2 * count));
    for (int i = 0; i < count && exception == 0; ++i) {
      const auto number = value(address + i);
      if (!number) exception = kIllegalAddress;
      reply.push_back(static_cast<std::uint8_t>(number.value_or(0) >> 8));
      reply.push_back(static_cast<std::uint8_t>(number.value_or(0)));
    }
  }
  if (exception != 0) reply = {slave_, static_cast<std::uint8_t>(request[1] | kError), exception};
  const std::uint16_t crc = modbus_crc(reply);
  reply.push_back(static_cast<std::uint8_t>(crc));
  reply.push_back(static_cast<std::uint8_t>(crc >> 8));
  return reply;
}

std::optional<std::uint16_t> ModbusDriveEmulator::value(int address) const {
  constexpr std::uint16_t kBothRun = 0x4141;
  constexpr std::uint16_t kBothInAlarm = 0xC0C0;
  switch (address) {
    case 0x2030:
    case 0x2060:
      return 1024;  // encoder lines
    case 0x20A1:
      return 4800;  // 0.01 V
    case 0x20A2:
      return faults_[0] != 0 || faults_[1] != 0 ? kBothInAlarm : kBothRun;
    case 0x20A3:
      return 0x0102;  // hall sensors
    case 0x20A4:
      return 0x1E1E;  // 30 degrees, both motors
    case 0x20A5:
    case 0x20A6:
      return faults_[static_cast<std::size_t>(address - 0x20A5)];
    case 0x20A7:
    case 0x20A8:
      return half(counts_[0], address == 0x20A7);
    case 0x20A9:
    case 0x20AA:
      return half(counts_[1], address == 0x20A9);
    case 0x20AB:
    case 0x20AC:
      return static_cast<std::uint16_t>(speeds_[static_cast<std::size_t>(address - 0x20AB)]);
    default:
      return {};
  }
}

}  // namespace curbstone::simulate::devices
