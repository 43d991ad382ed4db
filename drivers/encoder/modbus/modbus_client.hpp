#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "drivers/encoder/modbus/zlac_registers.hpp"

struct _modbus;  // libmodbus' context

namespace curbstone::encoder::modbus {

/// Where the drive is, and how long it may take to answer.
struct ModbusSettings {
  bool tcp = false;                     ///< a gateway, or a drive with Ethernet; otherwise a serial line, 8N1
  std::string device = "/dev/ttyUSB0";  ///< serial port
  int baud = 115200;
  std::string host = "192.168.1.10";  ///< IPv4 address
  int port = 502;
  int slave = 1;                  ///< 1..247; of a gateway, the unit behind it
  std::int64_t timeout = 60'000;  ///< us, from request to whole reply
};

/// What became of one request.
enum class Outcome {
  kOk,
  kTimeout,     ///< no reply, or not all of it, in time
  kSlow,        ///< a good reply, but later than the time allowed: its stamp would be too uncertain
  kCrc,         ///< the checksum is wrong
  kWrongSlave,  ///< of another slave (serial lines; libmodbus does not compare it over TCP)
  kMalformed,   ///< not the reply to this request: length, function, transaction
  kUnasked,     ///< bytes were there before the request: the reply to an earlier one. Nothing was sent
  kException,   ///< the drive, or the gateway, refuses
  kGone,        ///< the port or the connection is no more
};

struct Reply {
  Outcome outcome = Outcome::kGone;
  int exception = 0;            ///< its code: 1 function, 2 address, 3 value, 4 device failure...
  std::int64_t utime = 0;       ///< us since the Unix epoch, middle between request and reply
  std::int64_t round_trip = 0;  ///< us
};

/// A Modbus master that reads holding registers (function 03) by libmodbus, and can do nothing else: it has no call
/// that writes. After each error it throws away what the line still holds. Every call waits at most about twice the
/// timeout. One thread.
class ModbusClient {
 public:
  explicit ModbusClient(const ModbusSettings& settings);
  ~ModbusClient();
  ModbusClient(const ModbusClient&) = delete;
  ModbusClient& operator=(const ModbusClient&) = delete;

  /// Opens the port or the connection, anew if it was open. On failure returns one line that says why, else nothing.
  [[nodiscard]] std::string open();
  void close();
  [[nodiscard]] bool is_open() const { return context_ != nullptr; }

  /// `registers` is filled if the outcome is kOk; as large as the block.
  [[nodiscard]] Reply read(const Block& block, std::span<std::uint16_t> registers);

  /// "/dev/ttyUSB0, slave 1" or "192.168.1.10:502, unit 1".
  [[nodiscard]] std::string name() const;

 private:
  struct Free {
    void operator()(_modbus* context) const;
  };
  [[nodiscard]] int waiting_bytes() const;
  void drain();

  ModbusSettings settings_;
  std::unique_ptr<_modbus, Free> context_;
};

}  // namespace curbstone::encoder::modbus
