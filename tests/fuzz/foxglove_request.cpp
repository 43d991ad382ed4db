// What a client of the endpoint for Foxglove says: any text.
#include "services/viewer/foxglove/wire.hpp"
#include "tests/fuzz/support/require.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace curbstone;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto request = viewer::foxglove::parse_request(text);
  if (!request) return 0;
  fuzz::require(request->subscribe.empty() || request->unsubscribe.empty(), "it asks for one or the other");
  // {"id":0,"channelId":0} is the shortest subscription, a digit and a comma the shortest of those that end.
  fuzz::require(22 * request->subscribe.size() <= size, "no subscription that the text does not have");
  fuzz::require(2 * request->unsubscribe.size() <= size, "no end of one that the text does not have");
  return 0;
}
