#include <gtest/gtest.h>

#include <filesystem>

#include "tests/temporary_folder.hpp"
#include "tests/tools/simulate/drives.hpp"
#include "tools/simulate/rig/packet_spool.hpp"
#include "tools/simulate/sensors/lidar_model.hpp"
#include "tools/simulate/town_surroundings.hpp"

namespace curbstone::simulate::rig {
namespace {

constexpr std::int64_t kBegin = 1'750'000'000'000'000;
const rig::SimulateConfig kConfig;
const std::atomic<bool> kGoOn{false};

rig::Drive drive() {
  return {test_motion(),
          [] { return std::make_unique<TownSurroundings>(test_town(), sensors::LidarNoise{}); },
          kConfig,
          1200,
          0,
          1,
          0.5,
          kBegin};
}

TEST(PacketSpool, HoldsThePacketsOfTheModelWhateverTheNumberOfThreads) {
  const rig::Drive d = drive();
  const rig::PacketSpool one(d, "", 7, 1, kGoOn), three(d, "", 7, 3, kGoOn);
  ASSERT_EQ(one.size(), 376);
  TownSurroundings town(test_town(), {});
  sensors::LidarModel lidar({.rpm = 1200, .seed = 1, .start_utime = kBegin}, {}, test_motion(), town);
  for (std::int64_t i = 0; i < one.size(); ++i) {
    const auto expected = lidar.next();
    const std::int64_t utime = kBegin + i * 1332;
    ASSERT_EQ(one.packet(i, utime), expected.bytes) << i;
    ASSERT_EQ(three.packet(i, utime), expected.bytes) << i;
  }
}

TEST(PacketSpool, IsTakenAgainOnlyForTheSameDrive) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "packets.spool";
  const rig::Drive d = drive();
  EXPECT_FALSE(rig::PacketSpool(d, file, 7, 1, kGoOn).reused());
  EXPECT_TRUE(rig::PacketSpool(d, file, 7, 1, kGoOn).reused());
  EXPECT_FALSE(rig::PacketSpool(d, file, 8, 1, kGoOn).reused());
  std::filesystem::resize_file(file, 5000);
  EXPECT_THROW(rig::PacketSpool(d, file, 8, 1, kGoOn), std::runtime_error) << "cut off";
}

TEST(PacketSpool, StopsWhenCancelled) {
  const std::atomic<bool> stop{true};
  const rig::Drive d = drive();
  EXPECT_THROW(rig::PacketSpool(d, "", 7, 2, stop), std::runtime_error);
}

}  // namespace
}  // namespace curbstone::simulate::rig
