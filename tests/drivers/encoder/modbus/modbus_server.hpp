#pragma once

#include <modbus.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>

#include "common/time/clock.hpp"

namespace curbstone::test {

/// A ZLAC8015D as libmodbus serves it, on a line that the test gives it or on a TCP port of its own, in a thread of its
/// own. It misbehaves as set.
class ModbusServer {
 public:
  enum class Mood {
    kAnswers,
    kSilent,
    kLate,        ///< answers after `lateness`
    kBadCrc,      ///< serial lines only
    kWrongSlave,  ///< serial lines only
    kException,   ///< `exception` to everything
    kShort,       ///< a register less than was asked for
    kHangsUp,     ///< TCP only: closes the connection after each reply
  };
  static constexpr int kSlave = 1;

  /// Serves on a file descriptor that the caller keeps: the far end of a serial line.
  explicit ModbusServer(int line) : context_(modbus_new_rtu("/dev/null", 115200, 'N', 8, 1)) { begin(line); }
  /// Serves TCP on 127.0.0.1, port() says where.
  ModbusServer() : context_(modbus_new_tcp("127.0.0.1", 0)), tcp_(true) {
    listen();
    begin(-1);
  }
  ~ModbusServer() {
    stop_ = true;
    thread_.join();
    if (connection_ >= 0) close(connection_);
    if (listener_ >= 0) close(listener_);
    modbus_set_socket(context_, -1);
    modbus_mapping_free(map_);
    modbus_free(context_);
  }
  ModbusServer(const ModbusServer&) = delete;
  ModbusServer& operator=(const ModbusServer&) = delete;

  [[nodiscard]] int port() const { return port_; }
  /// The line is another one; -1: it is unplugged.
  void plug(int line) {
    line_ = line;
    while (served_ != line) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  /// TCP: ends the connection. Then nobody listens until listen_again().
  void drop() { listening_ = false; }
  void listen_again() { listening_ = true; }

  /// 20A2, 20A5, 2030, ...
  void set(int address, std::uint16_t value) {
    const std::lock_guard lock(mutex_);
    map_->tab_registers[address - kFirst] = value;
  }
  [[nodiscard]] std::set<int> functions() {
    const std::lock_guard lock(mutex_);
    return functions_;
  }
  [[nodiscard]] std::set<std::array<int, 2>> blocks() {  // address, count
    const std::lock_guard lock(mutex_);
    return blocks_;
  }

  /// us, steady clock: when the wheels stood at 0.
  [[nodiscard]] std::int64_t began_at() const { return begin_; }
  /// The wheels turn at this rate, the right one backwards; counted when the request has come.
  static constexpr double kCountsPerSecond = 10'000;
  std::atomic<Mood> mood = Mood::kAnswers;
  std::atomic<int> exception = 4;
  std::atomic<int> lateness = 100;  ///< ms
  std::atomic<int> most = 125;      ///< registers; a larger block is exception 02

 private:
  static constexpr int kFirst = 0x2000;

  void begin(int line) {
    map_ = modbus_mapping_new_start_address(0, 0, 0, 0, kFirst, 0x100, 0, 0);
    map_->tab_registers[0x2030 - kFirst] = 1024;
    map_->tab_registers[0x20A2 - kFirst] = 0x4141;  // both wheels held, and running
    modbus_set_slave(context_, kSlave);
    modbus_set_indication_timeout(context_, 0, 10'000);
    modbus_set_byte_timeout(context_, 0, 10'000);
    line_ = line;
    thread_ = std::thread([this] { run(); });
  }
  void listen() {
    listener_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const int on = 1;
    setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(port_));
    socklen_t size = sizeof address;
    if (bind(listener_, reinterpret_cast<sockaddr*>(&address), size) != 0 || ::listen(listener_, 1) != 0 ||
        getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size) != 0)
      throw std::runtime_error("no TCP port");
    port_ = ntohs(address.sin_port);
  }
  void put(int address, std::int32_t value) {
    map_->tab_registers[address - kFirst] = static_cast<std::uint16_t>(static_cast<std::uint32_t>(value) >> 16);
    map_->tab_registers[address - kFirst + 1] = static_cast<std::uint16_t>(value);
  }

  void run() {
    while (!stop_) {
      if (tcp_ && !accept_one()) continue;
      if (!tcp_) connection_ = line_.load();
      served_ = connection_.load();
      if (connection_ < 0) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        continue;
      }
      modbus_set_socket(context_, connection_);
      std::array<std::uint8_t, MODBUS_MAX_ADU_LENGTH> request{};
      const int size = modbus_receive(context_, request.data());
      if (size > 0) answer(request.data(), size);
      if (size > 0 && tcp_ && mood == Mood::kHangsUp) hang_up();
      if (size < 0 && errno == ECONNRESET && tcp_) hang_up();
    }
    if (!tcp_) connection_ = -1;
  }
  bool accept_one() {
    if (!listening_) {
      hang_up();
      if (listener_ >= 0) close(listener_);
      listener_ = -1;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      return false;
    }
    if (listener_ < 0) listen();
    if (connection_ >= 0) return true;
    pollfd wait{listener_, POLLIN, 0};
    if (poll(&wait, 1, 10) > 0) connection_ = accept(listener_, nullptr, nullptr);
    return connection_ >= 0;
  }
  void hang_up() {
    if (connection_ >= 0) close(connection_);
    connection_ = -1;
  }
  void answer(std::uint8_t* request, int size) {
    const int header = modbus_get_header_length(context_);
    const int function = request[header];
    const int address = request[header + 1] << 8 | request[header + 2];
    const int count = request[header + 3] << 8 | request[header + 4];
    const Mood now = mood;
    const std::lock_guard lock(mutex_);
    functions_.insert(function);
    blocks_.insert({address, count});
    const auto turned =
        static_cast<std::int32_t>(static_cast<double>(steady_clock() - begin_) * 1e-6 * kCountsPerSecond);
    put(0x20A7, turned);
    put(0x20A9, -turned);
    if (count > most) {
      modbus_reply_exception(context_, request, MODBUS_EXCEPTION_ILLEGAL_DATA_ADDRESS);
      return;
    }
    switch (now) {
      case Mood::kSilent:
        return;
      case Mood::kException:
        modbus_reply_exception(context_, request, static_cast<unsigned>(exception.load()));
        return;
      case Mood::kBadCrc:
      case Mood::kWrongSlave:
        answer_wrongly(count, now);
        return;
      case Mood::kShort:
        request[header + 4] = static_cast<std::uint8_t>(std::max(count - 1, 1));
        break;
      case Mood::kLate:
        std::this_thread::sleep_for(std::chrono::milliseconds(lateness));
        break;
      case Mood::kAnswers:
      case Mood::kHangsUp:
        break;
    }
    modbus_reply(context_, request, size, map_);
  }
  /// A reply of zeros, with the checksum of another or from another slave.
  void answer_wrongly(int count, Mood how) {
    std::array<std::uint8_t, 260> reply{};
    reply[0] = how == Mood::kWrongSlave ? kSlave + 1 : kSlave;
    reply[1] = 3;
    reply[2] = static_cast<std::uint8_t>(2 * count);
    const auto size = static_cast<std::size_t>(3 + 2 * count);
    const std::uint16_t sum = how == Mood::kBadCrc ? 0xBAD1 : crc({reply.data(), size});
    reply[size] = static_cast<std::uint8_t>(sum);
    reply[size + 1] = static_cast<std::uint8_t>(sum >> 8);
    (void)!write(connection_, reply.data(), size + 2);
  }
  static std::uint16_t crc(std::span<const std::uint8_t> bytes) {
    std::uint16_t sum = 0xFFFF;
    for (const std::uint8_t byte : bytes) {
      sum = static_cast<std::uint16_t>(sum ^ byte);
      for (int bit = 0; bit < 8; ++bit)
        sum = static_cast<std::uint16_t>((sum & 1) != 0 ? (sum >> 1) ^ 0xA001 : sum >> 1);
    }
    return sum;
  }

  modbus_t* context_;
  modbus_mapping_t* map_ = nullptr;
  bool tcp_ = false;
  int port_ = 0;
  int listener_ = -1;
  std::atomic<int> connection_ = -1;
  std::atomic<int> line_ = -1;
  std::atomic<int> served_ = -1;
  std::atomic<bool> listening_ = true;
  std::atomic<bool> stop_ = false;
  const std::int64_t begin_ = steady_clock();
  std::mutex mutex_;
  std::set<int> functions_;
  std::set<std::array<int, 2>> blocks_;
  std::thread thread_;
};

}  // namespace curbstone::test
