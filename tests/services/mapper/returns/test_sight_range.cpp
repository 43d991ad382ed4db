#include "services/mapper/returns/sight_range.hpp"

#include <gmock/gmock.h>

#include "tests/services/mapper/detection_scans.hpp"

namespace curbstone::mapper::returns {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

class SightRangeTest : public ::testing::Test {
 protected:
  template <class Sees>
  void check(int looks, Sees sees) {
    scan::Scan scan = drive_.next();
    std::erase_if(scan.points, [&](const scan::LidarPoint& point) { return !sees(point); });
    for (int i = 0; i < looks; ++i) sight_.check(scan);
  }
  void check(int looks, float end = INFINITY) {
    check(looks, [end](const scan::LidarPoint& point) { return point.position.norm() < end; });
  }
  test::DetectionScans drive_;
  SightRange sight_{test::default_lidar()};
};

TEST_F(SightRangeTest, NothingBeyondEightMetresIsNamedUntilItSeesFartherAgain) {
  check(40);
  EXPECT_FALSE(sight_.range());
  check(SightRange::kLooks - 1, 8.0F);
  EXPECT_FALSE(sight_.range()) << "not yet";
  check(1, 8.0F);
  ASSERT_TRUE(sight_.range());
  EXPECT_NEAR(*sight_.range(), 8.0, 0.2);
  std::vector<std::string> faults;
  sight_.add_faults(faults);
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_THAT(faults[0], HasSubstr("nothing comes back from beyond 8.0 m in any direction"));
  EXPECT_EQ(sight_.counters()["faults.lidar.short_sight"], 1);
  check(SightRange::kLooks);
  EXPECT_FALSE(sight_.range());
}

TEST_F(SightRangeTest, SoIsARangeThatWasLimitedFromTheStart) {
  check(SightRange::kLooks, 8.0F);
  EXPECT_TRUE(sight_.range());
}

TEST_F(SightRangeTest, SurroundingsThatEndAreNoFault) {
  drive_.world.boxes.clear();
  check(100);
  EXPECT_FALSE(sight_.range()) << "a plain";
  drive_.world.boxes = {
      {{-7, 5, 0}, {7, 6, 5}}, {{-7, -6, 0}, {7, -5, 5}}, {{6, -6, 0}, {7, 6, 5}}, {{-7, -6, 0}, {-6, 6, 5}}};
  check(100);
  EXPECT_FALSE(sight_.range()) << "a yard";
  drive_.world = test::street();
  check(100, [](const scan::LidarPoint& point) { return point.position.z() > -1.0F || point.position.norm() < 7.0F; });
  EXPECT_FALSE(sight_.range()) << "a wet road between houses";
  check(100, [](const scan::LidarPoint& point) { return point.position.x() < 0.0F || point.position.norm() < 7.0F; });
  EXPECT_FALSE(sight_.range()) << "an edge ahead";
  scan::Scan none;
  for (int i = 0; i < 100; ++i) sight_.check(none);
  EXPECT_FALSE(sight_.range());
}

}  // namespace
}  // namespace curbstone::mapper::returns
