#include "tools/simulate/rig/emulated_imu.hpp"

#include <gmock/gmock.h>

#include <curbstone/imu_t.hpp>
#include <functional>
#include <utility>

#include "drivers/imu/imu_node.hpp"
#include "tests/drivers/recorder.hpp"
#include "tests/stamps.hpp"
#include "tests/tools/simulate/drives.hpp"

namespace curbstone::simulate::rig {
namespace {

using test::kStart;

class EmulatedImuOfEitherMake : public ::testing::TestWithParam<bool> {};

TEST_P(EmulatedImuOfEitherMake, IsSetUpByItsDriverAndSaysWhatTheVehicleDoes) {
  const bool witmotion = GetParam();
  EmulatedImu device(sensors::ImuModel({}, {}, test_motion(), numerics::Random(4)), witmotion);
  curbstone::test::Recorder<imu_t> recorder("IMU");
  imu::ImuConfig config;
  config.model = witmotion ? imu::Model::kWitMotion : imu::Model::kXsens;
  std::vector<std::uint8_t> commands;
  imu::ImuNode node(config, recorder.bus(), [&](std::span<const std::uint8_t> bytes) {
    commands.insert(commands.end(), bytes.begin(), bytes.end());
  });
  node.on_bytes(kStart, device.power_on(kStart));
  std::int64_t now = kStart;
  /// 15 s in which the vehicle is where it is at `t` of the drive. @return samples published
  const auto run = [&](const std::function<double()>& t) {
    const std::size_t before = recorder.messages().size();
    for (const std::int64_t end = now + 15'000'000; now < end; now += 1000) {
      if ((now - kStart) % 20'000 == 0) node.tick(now);
      node.on_bytes(now, device.on_bytes(now, std::exchange(commands, {})));
      node.on_bytes(now, device.run(now, t()));
      recorder.messages();
    }
    return static_cast<double>(recorder.messages().size() - before);
  };
  EXPECT_GT(run([] { return 0.5; }), 1300) << "it stands";
  const auto& messages = recorder.messages();
  EXPECT_NEAR(messages.back().acceleration[2], 9.8, 0.2);
  EXPECT_TRUE(messages.back().has_orientation);
  EXPECT_NEAR(static_cast<double>(messages.back().utime - messages[messages.size() - 101].utime), 1e6, 2000);
  EXPECT_NEAR(run([&] { return static_cast<double>(now - kStart) * 1e-6; }), 1500, 2) << "it drives";
  const Counters counters = node.report().counters;
  for (const auto& [name, value] : counters.values()) EXPECT_FALSE(name.starts_with("withheld.")) << name << value;
  EXPECT_THAT(node.report().faults, ::testing::IsEmpty());
}
INSTANTIATE_TEST_SUITE_P(WitMotion, EmulatedImuOfEitherMake, ::testing::Bool());

}  // namespace
}  // namespace curbstone::simulate::rig
