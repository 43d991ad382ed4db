// The IMU driver of one model (FUZZ_MODEL): any bytes from the line, in any pieces. Input, repeated: time since the
// piece before (2 bytes, 10 us), length (2 bytes), piece.
#include <cmath>
#include <curbstone/imu_t.hpp>

#include "common/bus/local_bus.hpp"
#include "drivers/imu/imu_node.hpp"
#include "tests/fuzz/support/input.hpp"
#include "tests/fuzz/support/require.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace curbstone;
  LocalBus bus;
  imu::ImuConfig config;
  config.model = imu::Model::FUZZ_MODEL;
  imu::ImuNode node(config, bus);
  std::int64_t last = 0;
  bus.subscribe<imu_t>("IMU", [&](const imu_t& sample) {
    fuzz::require(sample.utime > last, "stamps increase");
    last = sample.utime;
    for (int i = 0; i < 3; ++i) {
      fuzz::require(std::isfinite(sample.acceleration[i]), "the acceleration is finite");
      fuzz::require(std::isfinite(sample.angular_rate[i]), "the rate of turn is finite");
    }
    double norm = 0;
    for (const double q : sample.orientation) norm += q * q;
    fuzz::require(!sample.has_orientation || std::abs(norm - 1) < 1e-3, "an orientation is a unit quaternion");
  });
  std::int64_t now = 1'700'000'000'000'000;  // us
  node.on_link(now, link::LinkState::kUp, "");
  for (fuzz::Input input(data, size); !input.empty();) {
    now += 10 * input.number<std::uint16_t>();
    node.on_bytes(now, input.piece());
    node.tick(now);
    bus.dispatch();
  }
  node.finish();
  bus.dispatch();
  (void)node.report();
  return 0;
}
