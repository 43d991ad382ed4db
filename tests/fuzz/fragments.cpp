// Fragments of large LCM messages, from several senders, at any times.
#include <array>

#include "common/bus/socket/fragment_assembler.hpp"
#include "tests/fuzz/support/input.hpp"
#include "tests/fuzz/support/require.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace curbstone;
  fuzz::Input input(data, size);
  constexpr FragmentAssembler::Limits kLimits = {.message = 5000, .total = 8000, .senders = 3};
  FragmentAssembler assembler({"CLOUD", "IMAGE"}, kLimits);
  std::int64_t now = 0;
  while (!input.empty()) {
    const auto sender = input.number<std::uint8_t>();
    now += std::int64_t{input.number<std::uint16_t>()} * 10;
    std::vector<std::uint8_t> datagram = {'L', 'C', '0', '3'};  // the others do not come here
    const fuzz::Bytes bytes = input.piece();
    datagram.insert(datagram.end(), bytes.begin(), bytes.end());
    const auto whole = assembler.add(sender, datagram, now);
    fuzz::require(assembler.held() <= kLimits.total, "memory is bounded");
    if (!whole) continue;
    fuzz::require(whole->bytes.size() <= kLimits.message, "no message is larger than allowed");
    fuzz::require(whole->bytes.size() <= size, "no byte is made up");
    fuzz::require(whole->channel == "CLOUD" || whole->channel == "IMAGE", "only what was asked for");
  }
  return 0;
}
