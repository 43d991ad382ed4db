// Whether wheels and gyro turn alike, as the filter says it. The mapper believes odometry rather than a scan only then.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "services/ekf/detection/turn_confirmation.hpp"
#include "tests/services/ekf/drawn_drives.hpp"
#include "tests/services/ekf/harmless_drives.hpp"
#include "tests/services/ekf/town_drive.hpp"
#include "tests/services/ekf/wheel_fault.hpp"

namespace curbstone::ekf::filter {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

Drive round_the_block(unsigned number, double speed = 3.0) {
  return simulate_town_drive({.seconds = 80, .speed = speed, .seed = 7000 + number, .town = number}, VehicleConfig());
}

Drive with_gyro(Drive drive, double scale) {
  for (base::ImuSample& sample : drive.imu) sample.angular_rate.z() *= scale;
  return drive;
}

struct Said {
  double share = 0.0;  // of the estimates, that confirm the turn
  double bends = 0.0;  // of those, likewise, in which the vehicle turns by 5 deg/s or more
  double worst = 0.0;  // deg, by which odometry turned otherwise than the vehicle in a second confirmed all through
};

Said said(const Drive& drive, double begin = 0.0, double end = 1e9) {
  Filter filter{base::EkfConfig()};
  const std::vector<model::Estimate> out = run(filter, drive);
  const auto turn = [](const Pose& from, const Pose& to) {
    return so3_log(Eigen::Quaterniond(from.linear().transpose() * to.linear())).z() / kDegree;
  };
  Said said;
  int all = 0, bends = 0, in_a_row = 0;
  for (std::size_t i = 100; i < out.size(); ++i) {
    const double t = base::seconds_between(drive.imu.front().utime, out[i].utime);
    const bool confirmed = out[i].turn_confirmed;
    in_a_row = confirmed ? in_a_row + 1 : 0;
    if (t < begin || t > end) continue;
    const std::size_t at = drive.index_of(out[i].utime);
    const double truly = turn(drive.truth[at - 100].T_world_base, drive.truth[at].T_world_base);
    const double otherwise = turn(out[i - 100].T_odom_base, out[i].T_odom_base) - truly;
    if (in_a_row > 100) said.worst = std::max(said.worst, std::abs(otherwise));
    said.share += confirmed ? 1 : 0;
    ++all;
    if (std::abs(truly) < 5) continue;
    said.bends += confirmed ? 1 : 0;
    ++bends;
  }
  said.share /= std::max(all, 1);
  said.bends /= std::max(bends, 1);
  return said;
}

TEST(TurnConfirmation, NeedsASecondInWhichTheyTurnAlike) {
  detection::TurnConfirmation turn;
  for (int i = 0; i < 20; ++i) {
    EXPECT_FALSE(turn.confirmed()) << i;
    turn.add(0.05, 0.5, 0.5 + (i % 2 == 0 ? 0.05 : -0.05));
  }
  EXPECT_TRUE(turn.confirmed());
  for (int i = 0; i < 4; ++i) turn.add(0.05, 0.5, 0.45);  // 0.01 rad
  EXPECT_FALSE(turn.confirmed());
  for (int i = 0; i < 20; ++i) turn.add(0.05, 0.5, 0.5);
  EXPECT_TRUE(turn.confirmed());
  turn.interrupt();
  EXPECT_FALSE(turn.confirmed());
}

TEST(TurnConfirmation, IsSaidOfAHealthyVehicleInItsBends) {
  for (const unsigned number : {1U, 2U, 3U}) {
    for (const double speed : {3.0, 5.0}) {
      const Said healthy = said(round_the_block(number, speed));
      EXPECT_GT(healthy.share, 0.85) << number << ' ' << speed;
      EXPECT_GT(healthy.bends, 0.85) << number << ' ' << speed;
      EXPECT_LT(healthy.worst, 0.5) << number << ' ' << speed;
    }
  }
}

TEST(TurnConfirmation, IsNotSaidInTheBendsOfAGyroWhoseScaleIsWrong) {
  for (const unsigned number : {1U, 2U, 3U}) {
    const Drive drive = round_the_block(number);
    for (const double scale : {0.85, 1.15})
      EXPECT_LT(said(with_gyro(drive, scale)).bends, 0.5) << number << ' ' << scale;
    for (const double scale : {0.5, 1.5})
      EXPECT_LT(said(with_gyro(drive, scale)).bends, 0.01) << number << ' ' << scale;
  }
}

void expect_never_said(double onset) {
  const Drive block = round_the_block(1);
  for (const WheelFault& fault : tried_wheel_faults())
    EXPECT_LT(said(with_fault(block, fault, onset)).worst, 0.5) << fault.name << ' ' << onset;
}

TEST(TurnConfirmation, IsNeverSaidWhereWheelsLeadOdometryAstray) {
  expect_never_said(20.0);
}

TEST(TurnConfirmation, IsNeverSaidWhereWheelsAreWrongFromTheStartOrAtOddsWithTheGround) {  // long
  expect_never_said(1.0);
  for (const HarmlessDrive& harmless : harmless_drives()) EXPECT_LT(said(harmless.make()).worst, 0.5) << harmless.name;
}

}  // namespace
}  // namespace curbstone::ekf::filter
