// A serial CAN adapter: any bytes from it. A frame that is read is written as the same line. Input, repeated: time
// since the piece before (2 bytes, 10 us), length (2 bytes), piece.
#include "drivers/encoder/can/slcan_channel.hpp"
#include "tests/fuzz/support/input.hpp"
#include "tests/fuzz/support/require.hpp"

namespace curbstone::fuzz {
namespace {

void check(const encoder::can::CanFrame& frame) {
  require(frame.size <= 8, "a frame has at most 8 bytes");
  require(frame.id <= (frame.extended ? 0x1FFFFFFFU : 0x7FFU), "an id has 11 or 29 bits");
  const std::vector<std::uint8_t> line = encoder::can::encode_slcan(frame);
  const auto again = encoder::can::parse_slcan_frame(text(line).substr(0, line.size() - 1));
  require(again && again->id == frame.id && again->size == frame.size && again->extended == frame.extended &&
              again->remote == frame.remote,
          "a frame that is written is read again");
}

}  // namespace
}  // namespace curbstone::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace curbstone;
  encoder::can::SlcanChannel channel(
      500, {.send = [](auto) {},
            .on_frame = [](std::int64_t, const encoder::can::CanFrame& frame) { fuzz::check(frame); },
            .on_open = [](std::int64_t) {},
            .on_refused = [](std::int64_t, const char*) {}});
  std::int64_t now = 1'000'000;  // us
  channel.start(now);
  for (fuzz::Input input(data, size); !input.empty();) {
    now += 10 * input.number<std::uint16_t>();
    channel.on_bytes(now, input.piece());
    channel.tick(now);
  }
  (void)channel.faults();
  (void)channel.counters();
  return 0;
}
