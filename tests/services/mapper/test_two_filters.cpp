#include <gtest/gtest.h>

#include "services/mapper/mapper.hpp"
#include "tests/services/mapper/mapper_drive.hpp"

namespace curbstone::mapper {
namespace {

using test::utime;

/// Somebody starts another filter on the bus after 2 s. Which of the two is heard first changes all the time.
TEST(TwoFilters, OneIsUsedAndNothingIsLost) {
  test::MapperDrive drive;
  const Pose T_second_first = test::pose(-4, 1, 0, 0, 0, 1.0);
  for (int i = -5; i < 500; ++i) {
    const double t = 0.01 * i;
    const Pose T_odom_base = drive.trajectory(0).inverse() * drive.trajectory(t);
    const scan::OdometrySample first{utime(t), T_odom_base, true, false};
    const scan::OdometrySample second{utime(t), T_second_first * T_odom_base, true, false};
    const bool second_comes_first = i >= 200 && i % 7 < 3;
    if (second_comes_first) (void)drive.odometry.add(second);
    (void)drive.odometry.add(first);
    if (i >= 200 && !second_comes_first) (void)drive.odometry.add(second);
  }
  EXPECT_TRUE(drive.odometry.has_second_filter());
  for (int i = 0; i < 90; ++i) {
    const auto update = drive.step();
    ASSERT_TRUE(update && update->registered) << i;
    EXPECT_LT(drive.error(*update), 0.03) << i;
  }
  EXPECT_EQ(drive.mapper->counters()["odometry.not_believed"], 0);
}

}  // namespace
}  // namespace curbstone::mapper
