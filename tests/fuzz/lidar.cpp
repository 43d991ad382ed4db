// The LiDAR driver of one model (FUZZ_MODEL): packets of any bytes, whatever was sent before. Input, repeated: time
// since the packet before (2 bytes, 10 us), length (2 bytes), packet.
#include <cmath>
#include <curbstone/lidar_points_t.hpp>

#include "common/bus/local_bus.hpp"
#include "drivers/lidar/lidar_node.hpp"
#include "tests/fuzz/support/input.hpp"
#include "tests/fuzz/support/require.hpp"

namespace curbstone::fuzz {
namespace {

constexpr std::int64_t kStart = 1'700'000'000'000'000;  // us
constexpr float kLensToAxis = 0.1F;                     // m, more than any model's

void check(const lidar_points_t& points, const lidar::LidarConfig& config) {
  const auto n = static_cast<std::size_t>(points.num_points);
  require(points.num_points >= 0, "the number of points is not negative");
  require(points.x.size() == n && points.ring.size() == n && points.time_offset.size() == n, "one value a point");
  for (std::size_t i = 0; i < n; ++i) {
    const float range = std::hypot(points.x[i], points.y[i], points.z[i]);
    require(std::isfinite(range), "points are finite");
    require(range >= config.min_range - kLensToAxis && range <= config.max_range + kLensToAxis, "points are in range");
    require(points.time_offset[i] >= 0 && points.time_offset[i] < 0.1F, "a point is of its packet's time");
    require(points.ring[i] >= 0 && points.ring[i] < 32, "a point is of a laser");
  }
}

std::int64_t accounted(const Counters& counters) {
  std::int64_t sum = counters["packets"] + counters["difop"] + counters["undecided"];
  for (const auto& [name, value] : counters.values()) sum += name.starts_with("refused.") ? value : 0;
  return sum;
}

}  // namespace
}  // namespace curbstone::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace curbstone;
  LocalBus bus;
  lidar::LidarConfig config;
  config.model = lidar::models::ModelName::FUZZ_MODEL;
  lidar::LidarNode node(config, bus, [] { return true; });
  int packets = 0, sent = 0;
  bus.subscribe<lidar_points_t>(config.channel, [&](const lidar_points_t& points) {
    ++sent;
    fuzz::check(points, config);
  });
  std::int64_t now = fuzz::kStart;
  for (fuzz::Input input(data, size); !input.empty(); ++packets) {
    now += 10 * input.number<std::uint16_t>();
    node.on_packet(now, 0, input.piece());
    node.tick(now);
    bus.dispatch();
  }
  node.finish();
  bus.dispatch();
  const Counters counters = node.report().counters;
  fuzz::require(sent == counters["packets"], "what is sent is counted");
  fuzz::require(fuzz::accounted(counters) == packets, "each packet is used, or refused under its cause");
  return 0;
}
