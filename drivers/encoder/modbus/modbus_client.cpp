#include "drivers/encoder/modbus/modbus_client.hpp"

#include <fmt/format.h>
#include <modbus.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>

#include <cerrno>

#include "common/time/clock.hpp"

namespace curbstone::encoder::modbus {

namespace {

constexpr std::int64_t kByteTimeout = 20'000;  // us, between two bytes of a reply
constexpr int kQuiet = 10;                     // ms without a byte, after which late bytes have arrived

Outcome outcome_of(int error) {
  switch (error) {
    case ETIMEDOUT:
      return Outcome::kTimeout;
    case EMBBADCRC:
      return Outcome::kCrc;
    case EMBBADSLAVE:
      return Outcome::kWrongSlave;
    case EMBBADDATA:
    case EMBBADEXC:
    case EMBUNKEXC:
    case EMBMDATA:
      return Outcome::kMalformed;
    default:
      return error > MODBUS_ENOBASE && error <= EMBXGTAR ? Outcome::kException : Outcome::kGone;
  }
}

}  // namespace

void ModbusClient::Free::operator()(_modbus* context) const {
  const int fd = modbus_get_socket(context);
  if (fd >= 0) tcflush(fd, TCIOFLUSH);  // otherwise closing a stuck port would wait for unsent bytes
  modbus_close(context);
  modbus_free(context);
}

ModbusClient::ModbusClient(const ModbusSettings& settings) : settings_(settings) {}
ModbusClient::~ModbusClient() = default;

std::string ModbusClient::name() const {
  return settings_.tcp ? fmt::format("{}:{}, unit {}", settings_.host, settings_.port, settings_.slave)
                       : fmt::format("{}, slave {}", settings_.device, settings_.slave);
}

std::string ModbusClient::open() {
  context_.reset();
  std::unique_ptr<_modbus, Free> context(settings_.tcp
                                             ? modbus_new_tcp(settings_.host.c_str(), settings_.port)
                                             : modbus_new_rtu(settings_.device.c_str(), settings_.baud, 'N', 8, 1));
  const auto failed = [&] { return fmt::format("cannot open Modbus {}: {}", name(), modbus_strerror(errno)); };
  const auto timeout = static_cast<std::uint32_t>(settings_.timeout);
  if (!context || modbus_set_slave(context.get(), settings_.slave) != 0 ||
      modbus_set_response_timeout(context.get(), 0, timeout) != 0 ||
      modbus_set_byte_timeout(context.get(), 0, kByteTimeout) != 0) {
    return failed();
  }
  errno = 0;
  if (modbus_connect(context.get()) != 0) {
    if (errno == 0 || errno == EINPROGRESS) errno = ETIMEDOUT;
    return failed();
  }
  if (!settings_.tcp) {
    const int fd = modbus_get_socket(context.get());
    if (ioctl(fd, TIOCEXCL) != 0) return failed();
    low_latency_ = serial::request_low_latency(fd, settings_.device);
  }
  modbus_flush(context.get());
  context_ = std::move(context);
  return {};
}

void ModbusClient::close() {
  context_.reset();
}

int ModbusClient::waiting_bytes() const {
  int bytes = 0;
  return ioctl(modbus_get_socket(context_.get()), FIONREAD, &bytes) == 0 ? bytes : 0;
}

/// Discards bytes until the line is quiet.
void ModbusClient::drain() {
  const std::int64_t end = steady_clock() + settings_.timeout;
  do {
    modbus_flush(context_.get());
    pollfd line{modbus_get_socket(context_.get()), POLLIN, 0};
    if (poll(&line, 1, kQuiet) <= 0 || (line.revents & (POLLHUP | POLLERR)) != 0) return;
    if (waiting_bytes() == 0) return;  // the end of the connection is readable too
  } while (steady_clock() < end);
}

Reply ModbusClient::read(const Block& block, std::span<std::uint16_t> registers) {
  Reply reply;
  if (!context_) return reply;
  if (waiting_bytes() > 0) {
    drain();
    reply.outcome = Outcome::kUnasked;
    return reply;
  }
  const std::int64_t sent = steady_clock();
  const int got = modbus_read_registers(context_.get(), block.address, block.count, registers.data());
  const int error = errno;
  reply.round_trip = steady_clock() - sent;
  reply.time = sent + reply.round_trip / 2;
  reply.utime = wall_clock() - reply.round_trip / 2;
  if (got == block.count) {
    reply.outcome = reply.round_trip <= settings_.timeout ? Outcome::kOk : Outcome::kSlow;
    return reply;
  }
  reply.outcome = outcome_of(error);
  if (reply.outcome == Outcome::kException) {
    reply.exception = error - MODBUS_ENOBASE;
    modbus_flush(context_.get());
  } else if (reply.outcome != Outcome::kGone) {
    drain();
  }
  return reply;
}

}  // namespace curbstone::encoder::modbus
