#include "services/mapper/returns/laser_order.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "tests/services/mapper/detection_scans.hpp"

namespace curbstone::mapper::returns {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Of the RS16.
float elevation_of(int ring) {
  return static_cast<float>((2.0 * ring - 15.0) * std::numbers::pi / 180);
}

/// What laser `is` measures is taken for what laser `taken(is)` does.
void take(scan::Scan& scan, const std::function<int(int)>& taken) {
  for (scan::LidarPoint& point : scan.points) {
    const int as = taken(point.ring);
    Eigen::Vector3f& p = point.position;
    const float range = p.norm(), level = p.head<2>().norm();
    p.head<2>() *= range * std::cos(elevation_of(as)) / level;
    p.z() = range * std::sin(elevation_of(as));
    point.ring = static_cast<std::uint8_t>(as);
  }
}

int two_swapped(int ring) {
  return ring == 3 ? 6 : ring == 6 ? 3 : ring;
}

int neighbours_swapped(int ring) {
  return ring == 4 ? 5 : ring == 5 ? 4 : ring;
}

int by_firing(int ring) {
  return ring < 8 ? 2 * ring : 2 * ring - 15;
}

class LaserOrderTest : public ::testing::Test {
 protected:
  void check(int looks, const std::function<void(scan::Scan&)>& change) {
    for (int i = 0; i < looks; ++i) {
      scan_ = drive_.next();
      change(scan_);
      order_.check(level_distances(scan_));
    }
  }
  std::vector<std::string> faults() const {
    std::vector<std::string> faults;
    order_.add_faults(faults);
    return faults;
  }

  test::DetectionScans drive_;
  scan::Scan scan_;
  LaserOrder order_{drive_.T_base_lidar};
};

TEST_F(LaserOrderTest, LasersInOrderKeepTheirPoints) {
  check(40, [](scan::Scan&) {});
  EXPECT_THAT(order_.wrong(), IsEmpty());
  EXPECT_THAT(faults(), IsEmpty());
}

TEST_F(LaserOrderTest, TwoThatAreSwappedAreNamedAndWithheldUntilTheyAreRight) {
  const auto swapped = [](scan::Scan& scan) { take(scan, two_swapped); };
  check(LaserOrder::kLooks - 1, swapped);
  EXPECT_THAT(order_.wrong(), IsEmpty()) << "not yet";
  check(1, swapped);
  ASSERT_THAT(order_.wrong(), ElementsAre(3, 6));
  order_.withhold(scan_);
  for (const scan::LidarPoint& point : scan_.points) ASSERT_TRUE(point.ring != 3 && point.ring != 6);
  EXPECT_THAT(faults().at(0), HasSubstr("2 of its lasers (3, 6; 0: the lowest) are taken for others"));
  check(LaserOrder::kLooks, [](scan::Scan&) {});
  EXPECT_THAT(order_.wrong(), IsEmpty());
}

TEST_F(LaserOrderTest, OfTwoNeighboursThatAreSwappedBothAreWithheld) {
  check(LaserOrder::kLooks, [](scan::Scan& scan) { take(scan, neighbours_swapped); });
  EXPECT_THAT(order_.wrong(), ElementsAre(4, 5));
}

TEST_F(LaserOrderTest, AnotherDevicesTableIsNamedAndAllAreUsed) {
  check(LaserOrder::kLooks, [](scan::Scan& scan) { take(scan, by_firing); });
  ASSERT_GT(order_.wrong().size(), 2U);
  const std::size_t before = scan_.points.size();
  order_.withhold(scan_);
  EXPECT_EQ(scan_.points.size(), before);
  EXPECT_THAT(faults().at(0), HasSubstr("the map is wrong"));
}

TEST_F(LaserOrderTest, ALidarThatIsUpsideDownHasItsLasersInOrder) {
  check(2 * LaserOrder::kLooks, [](scan::Scan& scan) {
    for (scan::LidarPoint& point : scan.points) point.position.tail<2>() *= -1;
  });
  EXPECT_THAT(order_.wrong(), IsEmpty());
}

TEST_F(LaserOrderTest, RingsThatCountFromAboveAreInOrder) {
  check(2 * LaserOrder::kLooks, [](scan::Scan& scan) {
    for (scan::LidarPoint& point : scan.points) point.ring = static_cast<std::uint8_t>(15 - point.ring);
  });
  EXPECT_THAT(order_.wrong(), IsEmpty());
}

}  // namespace
}  // namespace curbstone::mapper::returns
