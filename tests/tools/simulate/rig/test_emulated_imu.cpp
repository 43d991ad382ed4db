#include "tools/simulate/rig/emulated_imu.hpp"

#include <gmock/gmock.h>

#include <curbstone/imu_t.hpp>

#include "drivers/imu/imu_node.hpp"
#include "tests/drivers/recorder.hpp"
#include "tests/tools/simulate/drives.hpp"

namespace curbstone::simulate::rig {
namespace {

constexpr std::int64_t kStart = 1'700'000'000'000'000;  // us

class EmulatedImuOfEitherMake : public ::testing::TestWithParam<bool> {};

TEST_P(EmulatedImuOfEitherMake, IsSetUpByItsDriverAndSaysWhatTheVehicleDoes) {
  const bool witmotion = GetParam();
  EmulatedImu device(sensors::ImuModel({}, {}, test_motion(), numerics::Random(4)), witmotion);
  curbstone::testing::Recorder<imu_t> recorder("IMU");
  imu::ImuConfig config;
  config.model = witmotion ? imu::Model::kWitMotion : imu::Model::kXsens;
  std::vector<std::uint8_t> commands;
  imu::ImuNode node(config, recorder.bus(), [&](std::span<const std::uint8_t> bytes) {
    commands.insert(commands.end(), bytes.begin(), bytes.end());
  });
  node.on_bytes(kStart, device.power_on(kStart));
  for (std::int64_t now = kStart; now < kStart + 4'000'000; now += 1000) {
    if ((now - kStart) % 20'000 == 0) node.tick(now);
    node.on_bytes(now, device.on_bytes(now, std::exchange(commands, {})));
    node.on_bytes(now, device.run(now, 0.5));  // it stands
  }
  const auto& messages = recorder.messages();
  ASSERT_GT(messages.size(), 300u);
  EXPECT_NEAR(messages.back().acceleration[2], 9.8, 0.2);
  EXPECT_TRUE(messages.back().has_orientation);
  EXPECT_NEAR(static_cast<double>(messages.back().utime - messages[messages.size() - 101].utime), 1e6, 2000);
  EXPECT_THAT(node.report().faults, ::testing::IsEmpty());
}
INSTANTIATE_TEST_SUITE_P(WitMotion, EmulatedImuOfEitherMake, ::testing::Bool());

}  // namespace
}  // namespace curbstone::simulate::rig
