// The encoder driver on a CAN bus: any frames, of a CANopen drive (first byte even) or with raw signals (odd). Input
// after that byte, repeated: time since the frame before (2 bytes, 10 us), id (4 bytes), flags (1 byte), data (8
// bytes).
#include <cmath>
#include <curbstone/wheels_t.hpp>

#include "common/bus/local_bus.hpp"
#include "drivers/encoder/encoder_node.hpp"
#include "tests/fuzz/support/input.hpp"
#include "tests/fuzz/support/require.hpp"

namespace curbstone::fuzz {
namespace {

encoder::can::CanFrame frame_from(Input& input) {
  encoder::can::CanFrame frame;
  frame.id = input.number<std::uint32_t>();
  const auto flags = input.number<std::uint8_t>();
  frame.size = std::min<std::uint8_t>(flags & 15, 8);
  frame.extended = (flags & 16) != 0;
  frame.remote = (flags & 32) != 0;
  frame.id &= frame.extended ? 0x1FFFFFFF : 0x7FF;
  const Bytes bytes = input.take(8);
  std::copy(bytes.begin(), bytes.end(), frame.data.begin());
  return frame;
}

encoder::EncoderConfig config_from(std::uint8_t choice) {
  encoder::EncoderConfig config;
  if ((choice & 1) != 0) config.signals.kind = encoder::SignalKind::kCounts;
  if ((choice & 3) == 3) config.signals.kind = encoder::SignalKind::kSpeeds;
  return config;
}

}  // namespace
}  // namespace curbstone::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace curbstone;
  fuzz::Input input(data, size);
  const encoder::EncoderConfig config = fuzz::config_from(input.number<std::uint8_t>());
  LocalBus bus;
  encoder::EncoderNode node(config, bus);
  std::int64_t last = 0;
  bus.subscribe<wheels_t>("WHEELS", [&](const wheels_t& wheels) {
    fuzz::require(wheels.utime > last, "stamps increase");
    last = wheels.utime;
    for (int side = 0; side < 2; ++side) {
      fuzz::require(std::isfinite(wheels.angle[side]), "angles are finite");
      fuzz::require(std::abs(wheels.speed[side]) <= 2 * config.max_speed, "speeds are those of a wheel");
    }
  });
  std::int64_t now = 1'700'000'000'000'000;  // us
  while (!input.empty()) {
    now += 10 * input.number<std::uint16_t>();
    node.on_frame(now, fuzz::frame_from(input));
    node.tick(now);
    bus.dispatch();
  }
  node.finish();
  bus.dispatch();
  (void)node.report();
  return 0;
}
