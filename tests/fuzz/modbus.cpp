// What the driver makes of a Modbus drive's replies: any outcomes, any registers. Input, repeated: outcome (1 byte),
// exception (1 byte), time since the poll before (2 bytes, 10 us), registers (16 bytes).
#include <cmath>
#include <curbstone/wheels_t.hpp>

#include "common/bus/local_bus.hpp"
#include "drivers/encoder/modbus_node.hpp"
#include "tests/fuzz/support/input.hpp"
#include "tests/fuzz/support/require.hpp"

namespace curbstone::fuzz {
namespace {

using encoder::modbus::Outcome;

/// A drive that answers as the fuzzer says.
class Replies {
 public:
  Replies(const std::uint8_t* data, std::size_t size) : input_(data, size) {}

  [[nodiscard]] bool over() const { return input_.empty(); }
  [[nodiscard]] std::int64_t now() const { return now_; }

  encoder::modbus::Reply reply(std::span<std::uint16_t> registers) {
    encoder::modbus::Reply reply;
    reply.outcome = static_cast<Outcome>(input_.number<std::uint8_t>() % (static_cast<int>(Outcome::kGone) + 1));
    reply.exception = input_.number<std::uint8_t>();
    now_ += 10 * input_.number<std::uint16_t>();
    reply.utime = reply.time = now_;
    reply.round_trip = 2000;
    for (std::uint16_t& value : registers) value = input_.number<std::uint16_t>();
    return reply;
  }

 private:
  Input input_;
  std::int64_t now_ = 1'700'000'000'000'000;  // us
};

}  // namespace
}  // namespace curbstone::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace curbstone;
  fuzz::Replies replies(data, size);
  LocalBus bus;
  const encoder::EncoderConfig config;
  encoder::ModbusNode node(config, bus);
  bus.subscribe<wheels_t>("WHEELS", [&](const wheels_t& wheels) {
    for (int side = 0; side < 2; ++side) {
      fuzz::require(std::isfinite(wheels.angle[side]), "angles are finite");
      fuzz::require(std::abs(wheels.speed[side]) <= 2 * config.max_speed, "speeds are those of a wheel");
    }
  });
  encoder::modbus::DrivePoll poll(
      [&](const encoder::modbus::Block&, std::span<std::uint16_t> registers) { return replies.reply(registers); },
      [] {});
  while (!replies.over()) {
    poll.tick(replies.now());
    poll.poll([&](const encoder::modbus::Reading& reading) { node.on_reading(replies.now(), reading); });
    if (poll.must_reopen()) poll.restart();
    node.tick(replies.now());
    bus.dispatch();
  }
  (void)node.report();
  (void)poll.counters();
  return 0;
}
