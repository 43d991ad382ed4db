#include "services/mapper/mounting/scale_by_scans.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <functional>

#include "tests/services/mapper/mapper_drive.hpp"
#include "tests/services/mapper/mounting/avenue.hpp"

namespace curbstone::mapper::mounting {
namespace {

using test::kPeriod;

/// A straight drive at 3 m/s, and odometry that goes `rate(t)` times as fast.
class ScaleByScansTest : public ::testing::Test {
 protected:
  /// Returns the scale at the end, s.
  double scale_at(double end, const std::function<double(double)>& rate) {
    double by_odometry = 0;
    for (int n = 0; n * kPeriod < end; ++n) {
      const double t = n * kPeriod;
      const Pose T_world_base = test::pose(3 * t, 0, 0, 0, 0, 0);
      scale_.add(test::utime(t + 1), world_.snapshot(T_world_base, lidar_), T_world_base,
                 test::pose(by_odometry, 0, 0, 0, 0, 0));
      by_odometry += 3 * rate(t) * kPeriod;
    }
    return scale_.scale();
  }
  Pose lidar_ = test::default_lidar();
  test::SyntheticWorld world_ = test::avenue();
  ScaleByScans scale_{lidar_.translation()};
};

TEST_F(ScaleByScansTest, OdometryThatIsTooLongIsShortened) {
  EXPECT_NEAR(scale_at(4, [](double) { return 1.10; }), 1 / 1.10, 0.02);
}

TEST_F(ScaleByScansTest, OdometryThatIsTooShortIsLengthened) {
  EXPECT_NEAR(scale_at(4, [](double) { return 0.90; }), 1 / 0.90, 0.02);
}

TEST_F(ScaleByScansTest, GoodOdometryIsLeftAsItIs) {
  EXPECT_EQ(scale_at(4, [](double) { return 1.00; }), 1);
}

TEST_F(ScaleByScansTest, AChangeInTheMiddleOfADriveIsFollowed) {
  EXPECT_NEAR(scale_at(7, [](double t) { return t < 3 ? 1.0 : 0.88; }), 1 / 0.88, 0.02);
}

TEST_F(ScaleByScansTest, NothingIsCorrectedOnceOdometryIsRightAgain) {
  EXPECT_EQ(scale_at(7, [](double t) { return t < 3 ? 0.88 : 1.0; }), 1);
}

TEST_F(ScaleByScansTest, WhereNothingStandsItIsUnknown) {
  world_ = test::plain();
  EXPECT_EQ(scale_at(4, [](double) { return 1.10; }), 1);
}

/// The whole mapper in the avenue, with odometry that goes 0.9 times as fast as the vehicle. The first comparisons take
/// some 8 m: what counts is how much farther it falls behind after 12 m.
TEST(ScaleByScans, KeepsTheMapperInStepWhereNoSurfaceDoes) {
  test::MapperDrive drive;
  drive.world.boxes = test::avenue(40).boxes;
  drive.trajectory = [](double t) { return test::pose(3 * t, 0, 0, 0, 0, 0); };
  for (double t = -0.05; t < 8; t += 0.01) {
    scan::OdometrySample sample;
    sample.utime = test::utime(t);
    sample.T_odom_base = test::pose(2.7 * t, 0, 0, 0, 0, 0);
    drive.odometry.add(sample);
  }
  double behind = 0, behind_at_first = 0;
  while (drive.turn * kPeriod < 7) {
    const auto update = drive.step();
    if (!update) continue;
    behind = 3 * drive.turn * kPeriod - (drive.T_world_map * update->T_map_base).translation().x();
    if (drive.turn * kPeriod < 4) behind_at_first = behind;
  }
  std::printf("[ figure ] behind after 12 m: %.2f m, after 21 m: %.2f m\n", behind_at_first, behind);
  EXPECT_LT(behind - behind_at_first, 0.25);  // odometry: 0.9
}

}  // namespace
}  // namespace curbstone::mapper::mounting
