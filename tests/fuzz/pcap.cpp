// A capture file of any bytes, played through the LiDAR driver of a model that it is to find out.
#include <stdexcept>

#include "common/bus/local_bus.hpp"
#include "drivers/lidar/packet_feed.hpp"
#include "drivers/lidar/sources/capture_contents.hpp"
#include "tests/fuzz/support/memory_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace curbstone;
  const fuzz::MemoryFile file({data, size});
  LocalBus bus;
  lidar::LidarConfig config;
  config.model = lidar::models::ModelName::kAuto;
  config.pcap = file.name();
  try {
    const auto contents = lidar::sources::contents_of(file.name());
    fuzz::require(contents.packets <= static_cast<std::int64_t>(size), "a packet has a byte");
    (void)lidar::sources::to_text(contents);
    lidar::LidarNode node(config, bus, [] { return true; });
    fuzz::require(lidar::feed_whole_capture(config, node) <= contents.packets, "no packet comes from nowhere");
    bus.dispatch();
  } catch (const std::runtime_error&) {
    // No capture, or a damaged one, and said so.
  }
  return 0;
}
