// Wheels and gyro that turn unlike: which of them is wrong.
#include "services/ekf/mounting/turn_scale.hpp"

#include <cmath>
#include <random>
#include <utility>

#include "services/ekf/mounting/mounting_watch.hpp"
#include "tests/services/ekf/drawn_drives.hpp"
#include "tests/services/ekf/ekf_node_test.hpp"
#include "tests/services/ekf/town_drive.hpp"

namespace curbstone::ekf::mounting {
namespace {

/// The wheels turn, and the gyro does not: that is a slip, as no force pushes the vehicle sideways.
TEST(TurnScaleTest, AWheelThatSlipsAgainAndAgainOnAStraightRoadIsNotTheGyro) {
  for (const double period : {2.0, 10.0}) {
    for (const unsigned seed : {1U, 2U, 3U}) {
      DriveOptions o;
      o.seed = seed;
      o.seconds = 90;
      o.speed = 3;
      o.curves = 0.0;
      Drive drive = simulate_drive(o, VehicleConfig());
      double slipped = 0.0;  // rad
      double before = drive.wheels.front().angle[0];
      for (base::WheelSample& sample : drive.wheels) {
        const double turned = sample.angle[0] - std::exchange(before, sample.angle[0]);
        const double t = base::seconds_between(drive.wheels.front().utime, sample.utime);
        if (std::fmod(t, period) < 0.5) slipped += 0.6 * turned;
        sample.angle[0] += slipped;
      }
      MountingWatch of{VehicleConfig()};
      feed(drive, [&](const auto& sample) { of.add(sample); });
      EXPECT_FALSE(of.gyro_is_wrong()) << period << ' ' << seed;
    }
  }
}

TEST(TurnScaleTest, AGyroThatShowsNoTurnIsReported) {
  for (const unsigned number : {1U, 2U, 3U}) {
    const Drive good =
        simulate_town_drive({.seconds = 200, .speed = 3, .seed = 7000 + number, .town = number}, VehicleConfig());
    Drive in_another_unit = good, noise = good;
    std::mt19937 random(number);
    std::normal_distribution<double> draw(0.0, 0.003);
    for (base::ImuSample& sample : in_another_unit.imu) sample.angular_rate.z() /= 57.3;
    for (base::ImuSample& sample : noise.imu) sample.angular_rate.z() = draw(random);
    for (const Drive& drive : {in_another_unit, noise}) {
      MountingWatch of{VehicleConfig()};
      feed(drive, [&](const auto& sample) { of.add(sample); });
      EXPECT_TRUE(of.gyro_is_wrong()) << number;
    }
  }
}

}  // namespace
}  // namespace curbstone::ekf::mounting
