// What comes to a relay's port: any bytes.
#include "services/relay/frame.hpp"

#include <algorithm>

#include "tests/fuzz/support/require.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace curbstone;
  const auto frame = relay::decode_frame({data, size});
  if (!frame) return 0;
  const std::size_t message = frame->channel.empty() ? 0 : frame->channel.size() + 1 + frame->data.size();
  fuzz::require(relay::kFrameHeader + message == size, "nothing is left over and nothing made up");
  fuzz::require(frame->channel.size() <= 63, "the bus takes the channel");
  fuzz::require(frame->channel.find('\0') == std::string_view::npos, "the channel ends at its end");
  const auto header = relay::encode_frame_header(frame->run, frame->number);
  fuzz::require(std::equal(header.begin(), header.end(), data), "the header is that of its numbers");
  return 0;
}
