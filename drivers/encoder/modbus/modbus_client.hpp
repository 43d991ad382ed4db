#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "drivers/encoder/modbus/zlac_registers.hpp"
#include "drivers/serial/low_latency.hpp"

struct _modbus;  // libmodbus' context

namespace curbstone::encoder::modbus {

/// Address of the drive, and its time-out.
struct ModbusSettings {
  bool tcp = false;                     ///< a gateway, or a drive with Ethernet; otherwise a serial line, 8N1
  std::string device = "/dev/ttyUSB0";  ///< serial port
  int baud = 115200;
  std::string host = "192.168.1.10";  ///< IPv4 address
  int port = 502;
  int slave = 1;                  ///< 1..247; for a gateway, the unit behind it
  std::int64_t timeout = 60'000;  ///< us, from request to whole reply
};

/// Result of a request.
enum class Outcome {
  kOk,
  kTimeout,     ///< no reply, or an incomplete one, in time
  kSlow,        ///< a valid reply, but later than allowed: its stamp would be too uncertain
  kCrc,         ///< the checksum is wrong
  kWrongSlave,  ///< reply of another slave (serial lines; libmodbus does not compare it over TCP)
  kMalformed,   ///< not the reply to this request: length, function, transaction
  kUnasked,     ///< bytes were waiting before the request: the reply to an earlier one. Nothing was sent
  kException,   ///< the drive or the gateway refuses
  kGone,        ///< the port or the connection has vanished
};

struct Reply {
  Outcome outcome = Outcome::kGone;
  int exception = 0;            ///< its code: 1 function, 2 address, 3 value, 4 device failure...
  std::int64_t utime = 0;       ///< us since the Unix epoch, middle between request and reply
  std::int64_t time = 0;        ///< the same instant by the steady clock, us
  std::int64_t round_trip = 0;  ///< us
};

/// A Modbus master that only reads holding registers (function 03), by libmodbus: it has no call that writes. After
/// each error it discards what the line still holds. A call takes at most about twice the time-out. One thread.
class ModbusClient {
 public:
  explicit ModbusClient(const ModbusSettings& settings);
  ~ModbusClient();
  ModbusClient(const ModbusClient&) = delete;
  ModbusClient& operator=(const ModbusClient&) = delete;

  /// Opens the port or the connection, or reopens it. Returns the reason of a failure in one line, else an empty
  /// string.
  [[nodiscard]] std::string open();
  void close();
  /// Of the serial port, as granted when it was opened last.
  [[nodiscard]] const serial::LowLatency& low_latency() const { return low_latency_; }

  /// `registers` is filled if the outcome is kOk; its size is that of the block.
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
  serial::LowLatency low_latency_;
};

}  // namespace curbstone::encoder::modbus
