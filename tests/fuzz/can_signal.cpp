// A signal's description from a configuration, up to the first line end, and a frame to read it from.
#include <cmath>
#include <stdexcept>

#include "drivers/encoder/signals/can_signal.hpp"
#include "tests/fuzz/support/input.hpp"
#include "tests/fuzz/support/require.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace curbstone;
  const std::string_view all = fuzz::text({data, size});
  const std::string_view description = all.substr(0, all.find('\n'));
  try {
    const auto signal = encoder::signals::CanSignal::parse(description);
    encoder::can::CanFrame frame;
    frame.id = signal.id;
    frame.extended = signal.extended;
    fuzz::Input input(data, size);
    frame.size = static_cast<std::uint8_t>(size % 9);
    input.take(description.size() + 1);
    const fuzz::Bytes bytes = input.take(8);
    std::copy(bytes.begin(), bytes.end(), frame.data.begin());
    fuzz::require(signal.is_in(frame), "a frame of its id has the signal");
    if (const auto raw = signal.raw(frame)) {
      const bool fits =
          signal.length == 64 || !signal.is_signed || std::abs(*raw) <= std::int64_t{1} << (signal.length - 1);
      fuzz::require(fits, "a signal has no more bits than it says");
      fuzz::require(std::isfinite(signal.value(*raw)) || !std::isfinite(signal.factor) ||
                        !std::isfinite(signal.offset) || std::abs(signal.factor) > 1e200 ||
                        std::abs(signal.offset) > 1e200,
                    "a value is finite");
    }
  } catch (const std::runtime_error&) {
    // Not a description, and said so.
  }
  return 0;
}
