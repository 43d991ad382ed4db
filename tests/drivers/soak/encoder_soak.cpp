#include <chrono>
#include <cmath>
#include <curbstone/wheels_t.hpp>
#include <deque>
#include <optional>
#include <utility>

#include "common/bus/local_bus.hpp"
#include "drivers/encoder/encoder_node.hpp"
#include "tests/drivers/soak/soak.hpp"
#include "tests/stamps.hpp"
#include "tools/simulate/devices/can_drive_emulator.hpp"

namespace curbstone::test {

namespace {

using encoder::can::CanFrame;

using test::kStart;
constexpr double kCountsPerSecond = 6519;  // 10 rad/s
constexpr std::uint32_t kPositions = 0x181;

void corrupt_frame(CanFrame& frame, std::mt19937& random) {
  frame.data[3] ^= static_cast<std::uint8_t>(1 + random() % 255);
}

void cut_frame(CanFrame& frame, std::mt19937& random) {
  frame.size = static_cast<std::uint8_t>(random() % 8);
}

std::int32_t counts_at(std::int64_t utime) {
  return static_cast<std::int32_t>(std::floor(static_cast<double>(utime - kStart) * 1e-6 * kCountsPerSecond));
}

}  // namespace

Soak soak_can(double hours) {
  const auto begin = std::chrono::steady_clock::now();
  Soak soak;
  Ledger& ledger = soak.ledger;
  LocalBus bus;
  std::deque<CanFrame> commands;
  encoder::EncoderConfig config;
  encoder::EncoderNode node(config, bus, [&](const CanFrame& frame) { commands.push_back(frame); });
  simulate::devices::CanDriveEmulator drive;

  struct Sample {
    std::int64_t index, taken;
    std::int32_t counts;
  };
  std::deque<Sample> recent;
  std::int64_t next_index = 0;
  std::optional<std::int64_t> first_counts;  // the driver counts from its first sample
  bool answers_start = true;                 // the next positions: they are left out
  bus.subscribe<wheels_t>("WHEELS", [&](const wheels_t& message) {
    if (!first_counts) first_counts = recent.front().counts - message.counts[0];
    for (const Sample& sample : recent) {
      if (sample.counts == message.counts[0] + *first_counts)
        return ledger.used(sample.index, message.utime - sample.taken);
    }
    ledger.used(-1, 0);
  });

  Damage<CanFrame> damage(3, {corrupt_frame, cut_frame});
  const auto length = static_cast<std::int64_t>(hours * 3600e6);
  std::int64_t now = kStart;
  const auto receive = [&](std::int64_t at, const std::vector<CanFrame>& frames) {
    for (const CanFrame& frame : frames) {
      const std::int64_t passed = at - kStart;
      const bool spare = passed < 2'000'000 || passed > length - 2'000'000 || frame.id != kPositions;
      const Fate fate = damage.draw(spare);
      const auto deliver = [&](const CanFrame& arrived) { node.on_frame(at + 200, arrived); };
      if (frame.id == kPositions && std::exchange(answers_start, false)) {
        deliver(frame);
        continue;
      }
      if (frame.id == kPositions) {
        ledger.sent(next_index, fate);
        recent.push_back({next_index++, at, counts_at(at)});
        if (recent.size() > 1000) recent.pop_front();
      }
      damage.pass(frame, fate, deliver);
    }
  };
  const auto set_counts = [&](std::int64_t at) { drive.set_counts(counts_at(at), -counts_at(at)); };
  receive(now, drive.power_on(now));
  for (; now < kStart + length; now += 1000) {
    if ((now - kStart) % 20'000 == 0) node.tick(now);
    for (; !commands.empty(); commands.pop_front()) {
      set_counts(now);
      receive(now, drive.on_frame(now, CanFrame(commands.front())));
    }
    for (auto due = drive.next_due(); due && *due < now + 1000; due = drive.next_due()) {
      set_counts(*due);
      receive(*due, drive.tick(*due));
    }
    damage.release([&](const CanFrame& late) { node.on_frame(now + 1000, late); });
    bus.dispatch();
    if ((now - kStart) % 1'000'000 == 0)
      ledger.look(node.report(), static_cast<double>(now - kStart) / static_cast<double>(length));
  }
  node.finish();
  bus.dispatch();
  soak.report = node.report();
  ledger.print("encoder (ZLAC8015D on CAN)", hours,
               std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(), soak.report);
  return soak;
}

}  // namespace curbstone::test
