// Packets of a drive, through the driver's own decoder, against the world they were made in.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "drivers/lidar/models/rs16/rs16_decoder.hpp"
#include "tests/tools/simulate/drives.hpp"
#include "tools/simulate/devices/rs16_emulator.hpp"
#include "tools/simulate/sensors/lidar_model.hpp"
#include "tools/simulate/town_surroundings.hpp"

namespace curbstone::simulate::sensors {
namespace {

constexpr std::int64_t kStart = 1'750'000'000'000'000;

sensors::LidarNoise no_noise() {
  return {.range_sigma = 0, .drop_out = 0, .mixed_pixels = 0};
}

TEST(LidarModel, PacketsFollowEachOtherInTimeAndAzimuth) {
  TownSurroundings town(test_town(), {});
  sensors::LidarModel lidar({.rpm = 1200, .seed = 1, .start_utime = kStart}, {}, test_motion(), town);
  lidar::models::rs16::Rs16Decoder decoder({});
  lidar::decoding::DecodedPacket packet;
  std::int64_t last = 0;
  for (int i = 0; i < 60; ++i) {
    const auto sent = lidar.next();
    ASSERT_EQ(decoder.decode(sent.bytes, packet), lidar::decoding::Refusal::kNone);
    ASSERT_TRUE(packet.stamp.has_value());
    EXPECT_NEAR(static_cast<double>(*packet.stamp - kStart), i * 1332.0, 1.0);
    if (i > 0) {
      EXPECT_NEAR(static_cast<double>(*packet.stamp - last), 1332.0, 1.0);
    }
    last = *packet.stamp;
    EXPECT_NEAR(std::remainder(packet.azimuth - std::fmod(i * 24 * 39.96, 36000.0), 36000.0), 0.0, 1.0);
  }
}

TEST(LidarModel, RaysOfAMovingVehicleLieOnTheTrueGround) {
  TownSurroundings surroundings(test_town(), no_noise());
  sensors::LidarModel lidar({.rpm = 1200, .seed = 1, .start_utime = kStart}, {}, test_motion(), surroundings);
  lidar::models::rs16::Rs16Decoder decoder({});
  lidar::models::rs16::DeviceInfo device;
  device.elevations = devices::Rs16EmulatorConfig().elevations;
  decoder.set_device(device);
  const world::Ground& ground = test_town().scene->ground();
  const Pose T_base_lidar = VehicleConfig{}.T_base_lidar();
  lidar.skip_to(15'000);  // 20 s: driving
  int on_road = 0, off = 0;
  for (int i = 0; i < 75; ++i) {
    const auto sent = lidar.next();
    lidar::decoding::DecodedPacket packet;
    ASSERT_EQ(decoder.decode(sent.bytes, packet), lidar::decoding::Refusal::kNone);
    for (std::size_t k = 0; k < packet.x.size(); ++k) {
      const Eigen::Vector3d p(static_cast<double>(packet.x[k]), static_cast<double>(packet.y[k]),
                              static_cast<double>(packet.z[k]));
      if (packet.ring[k] > 5 || p.norm() > 15) continue;
      const double t = sent.t + static_cast<double>(packet.time_offset[k]);
      const Eigen::Vector3d world = test_motion().T_world_base(t) * T_base_lidar * p;
      const auto x = static_cast<float>(world.x()), y = static_cast<float>(world.y());
      const world::GroundVertex node = ground.at(x, y);
      if (node.distance > -0.1F) continue;  // the carriageway: nothing but cars stands there
      const double above = world.z() - static_cast<double>(ground.height_of(node));
      if (above > 0.15) continue;
      ++on_road;
      off += std::abs(above) > 0.012 ? 1 : 0;
    }
  }
  EXPECT_GT(on_road, 2000);
  EXPECT_LT(off, on_road / 200);
}

TEST(LidarModel, FiresEachDeviceAtItsOwnPace) {
  const std::pair<devices::LidarName, double> devices[] = {{devices::LidarName::kVlp16, 1327.104e-6},
                                                           {devices::LidarName::kHelios16p, 1333.44e-6},
                                                           {devices::LidarName::kHelios32, 666.72e-6}};
  for (const auto& [name, period] : devices) {
    TownSurroundings town(test_town(), no_noise());
    sensors::LidarModel lidar({.rpm = 1200, .seed = 1, .start_utime = kStart, .lidar = name}, {}, test_motion(), town);
    const auto first = lidar.next(), second = lidar.next();
    EXPECT_NEAR(second.t - first.t, period, 1e-9) << lidar.table().name;
    EXPECT_LT(first.t_last, second.t);
    EXPECT_EQ(first.bytes.size(), lidar.table().packet_size);
    EXPECT_NE(first.bytes, second.bytes);
  }
}

TEST(LidarModel, APacketDoesNotDependOnThoseBefore) {
  TownSurroundings town_a(test_town(), {}), town_b(test_town(), {});
  sensors::LidarModel a({.rpm = 1200, .seed = 3, .start_utime = kStart}, {}, test_motion(), town_a),
      b({.rpm = 1200, .seed = 3, .start_utime = kStart}, {}, test_motion(), town_b);
  for (int i = 0; i < 7; ++i) (void)a.next();
  b.skip_to(7);
  EXPECT_EQ(a.next().bytes, b.next().bytes);
}

TEST(LidarModel, SeesTheSameForTheSameSeedOnly) {
  TownSurroundings town_a(test_town(), {}), town_b(test_town(), {});
  sensors::LidarModel a({.rpm = 1200, .seed = 3, .start_utime = kStart}, {}, test_motion(), town_a),
      b({.rpm = 1200, .seed = 4, .start_utime = kStart}, {}, test_motion(), town_b);
  EXPECT_NE(a.next().bytes, b.next().bytes);
}

}  // namespace
}  // namespace curbstone::simulate::sensors
