#include <algorithm>
#include <chrono>
#include <cmath>
#include <curbstone/wheels_t.hpp>
#include <deque>
#include <optional>

#include "common/bus/local_bus.hpp"
#include "drivers/encoder/modbus_node.hpp"
#include "tests/drivers/byte_stream.hpp"
#include "tests/drivers/soak/soak.hpp"
#include "tests/stamps.hpp"
#include "tools/simulate/devices/modbus_drive_emulator.hpp"

namespace curbstone::test {

namespace {

using encoder::modbus::Block;
using encoder::modbus::Outcome;
using encoder::modbus::Reply;

using test::kStart;
constexpr double kCountsASecond = 6519;    // 10 rad/s
constexpr std::int64_t kByte = 87;         // us on the line, at 115200 baud
constexpr std::int64_t kTimeout = 60'000;  // us, of the driver's settings

std::int32_t wheel_counts_at(std::int64_t utime) {
  return static_cast<std::int32_t>(std::floor(static_cast<double>(utime - kStart) * 1e-6 * kCountsASecond));
}

/// The line of a drive, on a clock of its own, with what libmodbus makes of its bytes: a reply must have the checksum,
/// and the length that was asked for. What is left on the line is there before the next request, and drained.
class DriveLine {
 public:
  struct Sample {
    std::int64_t index, taken;
    std::int32_t counts;
  };

  explicit DriveLine(Ledger& ledger) : ledger_(ledger) {}

  Reply read(const Block& block, std::span<std::uint16_t> registers) {
    Reply reply;
    if (!waiting_.empty()) {
      waiting_.clear();
      now += 10'000;
      reply.outcome = Outcome::kUnasked;
      return reply;
    }
    const std::int64_t asked = now;
    const Bytes whole = ask(block);
    const std::int64_t answers = now;
    const bool is_position = block.count > 3 && !std::exchange(first_, false);
    const Fate fate = damage_.draw(spare || block.count <= 3);
    if (is_position) {
      ledger_.sent(next_index_, fate);
      recent.push_back({next_index_++, taken_, wheel_counts_at(taken_)});
      if (recent.size() > 100) recent.pop_front();
    }
    // The one that was late comes now, before the reply to this request, and is taken for it.
    Bytes line = std::exchange(late_, {});
    if (fate == Fate::kSwapped) {
      late_ = whole;
    } else {
      damage_.pass(whole, fate, [&](const Bytes& bytes) { append(line, bytes); });
    }
    const std::size_t size = 5 + 2 * static_cast<std::size_t>(block.count);
    reply.outcome = judge(line, size, block);
    now = reply.outcome == Outcome::kOk ? answers + static_cast<std::int64_t>(size) * kByte : asked + kTimeout;
    if (line.size() > size && reply.outcome == Outcome::kOk)
      waiting_.assign(line.begin() + static_cast<std::ptrdiff_t>(size), line.end());
    reply.round_trip = now - asked;
    reply.time = reply.utime = asked + reply.round_trip / 2;
    for (std::size_t i = 0; reply.outcome == Outcome::kOk && i < registers.size(); ++i)
      registers[i] = static_cast<std::uint16_t>(line[3 + 2 * i] << 8 | line[4 + 2 * i]);
    return reply;
  }

  std::int64_t now = kStart;
  bool spare = true;
  std::deque<Sample> recent;
  std::optional<std::int32_t> first_counts;

 private:
  Bytes ask(const Block& block) {
    Bytes request = {1, 3};
    for (const int word : {block.address, block.count}) {
      request.push_back(static_cast<std::uint8_t>(word >> 8));
      request.push_back(static_cast<std::uint8_t>(word));
    }
    const std::uint16_t crc = simulate::devices::modbus_crc(request);
    request.push_back(static_cast<std::uint8_t>(crc));
    request.push_back(static_cast<std::uint8_t>(crc >> 8));
    now += static_cast<std::int64_t>(request.size()) * kByte;
    const std::int64_t takes = 500 + static_cast<std::int64_t>(random_() % 1000);
    taken_ = now + takes / 2;
    now += takes;
    device_.set_counts(wheel_counts_at(taken_), -wheel_counts_at(taken_));
    if (!first_counts && block.count > 3) first_counts = wheel_counts_at(taken_);
    device_.set_speeds(955, -955);
    (void)device_.on_bytes(request);
    return device_.answer();
  }
  /// As libmodbus reads: up to the length that the byte count says.
  static Outcome judge(const Bytes& line, std::size_t size, const Block& block) {
    if (line.size() < 3 || line.size() < 5U + line[2]) return Outcome::kTimeout;
    const std::span<const std::uint8_t> reply(line.data(), 5U + line[2]);
    const unsigned sum = reply[reply.size() - 2] | static_cast<unsigned>(reply.back()) << 8;
    if (simulate::devices::modbus_crc(reply.first(reply.size() - 2)) != sum) return Outcome::kCrc;
    if (reply[1] != 3 || reply.size() != size || line[2] != 2 * block.count) return Outcome::kMalformed;
    return Outcome::kOk;
  }

  static void flip(Bytes& bytes, std::mt19937& random) {
    bytes[random() % bytes.size()] ^= static_cast<std::uint8_t>(1 + random() % 255);
  }

  Ledger& ledger_;
  simulate::devices::ModbusDriveEmulator device_;
  Damage<Bytes> damage_{7, {flip, cut}};
  std::mt19937 random_{8};
  Bytes late_;     // the reply that will come with the next one
  Bytes waiting_;  // on the line before the next request
  std::int64_t taken_ = 0;
  std::int64_t next_index_ = 0;
  bool first_ = true;
};

}  // namespace

Soak soak_modbus(double hours) {
  const auto begin = std::chrono::steady_clock::now();
  Soak soak;
  Ledger& ledger = soak.ledger;
  LocalBus bus;
  encoder::EncoderConfig config;
  config.interface = encoder::Interface::kModbusRtu;
  encoder::ModbusNode node(config, bus);
  DriveLine line(ledger);
  encoder::modbus::DrivePoll poll(
      [&](const Block& block, std::span<std::uint16_t> registers) { return line.read(block, registers); },
      [&] { line.now += 2000; });
  node.add_report([&](NodeReport& report) {
    report.counters.add(poll.counters());
    if (!poll.fault().empty()) report.faults.push_back(poll.fault());
    if (poll.share().fault()) report.faults.push_back(*poll.share().fault());
  });
  bus.subscribe<wheels_t>("WHEELS", [&](const wheels_t& message) {
    for (const DriveLine::Sample& sample : line.recent) {
      if (sample.counts == message.counts[0] + *line.first_counts)
        return ledger.used(sample.index, message.utime - sample.taken);
    }
    ledger.used(-1, 0);
  });

  const auto length = static_cast<std::int64_t>(hours * 3600e6);
  const auto period = static_cast<std::int64_t>(1e6 / config.modbus.rate);
  std::int64_t next_look = kStart;
  for (std::int64_t due = kStart; due < kStart + length; due += period) {
    line.now = std::max(line.now, due);
    line.spare = due < kStart + 2'000'000 || due > kStart + length - 2'000'000;
    poll.tick(line.now);
    poll.poll([&](const encoder::modbus::Reading& reading) { node.on_reading(line.now, reading); });
    if (poll.must_reopen()) poll.restart();
    node.tick(line.now);
    bus.dispatch();
    if (line.now < next_look) continue;
    next_look = line.now + 1'000'000;
    ledger.look(node.report(), static_cast<double>(due - kStart) / static_cast<double>(length));
  }
  soak.report = node.report();
  ledger.print("encoder (ZLAC8015D on Modbus)", hours,
               std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(), soak.report);
  return soak;
}

}  // namespace curbstone::test
