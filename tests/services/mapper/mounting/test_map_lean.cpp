#include "services/mapper/mounting/map_lean.hpp"

#include <gmock/gmock.h>

#include "tests/services/mapper/detection_scans.hpp"

namespace curbstone::mapper::mounting {
namespace {

/// 20 revolutions a second of a vehicle on a slope, which turns; the map's z leans by `degrees` against odometry's.
class MapLeanTest : public ::testing::Test {
 protected:
  void drive(double seconds, double degrees) {
    const Pose T_map_odom = test::pose(3, 2, 0, 0, degrees * M_PI / 180, 1);
    for (double end = t_ + seconds; t_ < end; t_ += 0.05) {
      const Pose T_odom_base = test::pose(3 * t_, 0, 0, 0.05, -0.2, 0.3 * t_);
      lean_.add(test::utime(t_), T_map_odom * T_odom_base, T_odom_base);
    }
  }
  std::vector<std::string> faults() const {
    std::vector<std::string> faults;
    lean_.add_faults(faults);
    return faults;
  }
  double t_ = 0;
  MapLean lean_;
};

TEST_F(MapLeanTest, OfAFewDegreesIsNoFault) {
  drive(20, 4.5);
  EXPECT_THAT(faults(), ::testing::IsEmpty());
}

TEST_F(MapLeanTest, OfMoreForSomeSecondsIsOneUntilItIsNoMore) {
  drive(2, 12);
  EXPECT_THAT(faults(), ::testing::IsEmpty());
  drive(2, 12);
  ASSERT_EQ(faults().size(), 1U);
  EXPECT_THAT(faults()[0], ::testing::HasSubstr("the map leans by 12 deg against gravity"));
  EXPECT_EQ(lean_.counters()["faults.apart.lean"], 1);
  drive(1, 0);
  EXPECT_THAT(faults(), ::testing::IsEmpty());
}

}  // namespace
}  // namespace curbstone::mapper::mounting
