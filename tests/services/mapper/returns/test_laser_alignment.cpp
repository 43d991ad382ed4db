#include "services/mapper/returns/laser_alignment.hpp"

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

void turn(scan::Scan& scan, int ring, double degrees) {
  const float c = static_cast<float>(std::cos(degrees * std::numbers::pi / 180));
  const float s = static_cast<float>(std::sin(degrees * std::numbers::pi / 180));
  for (scan::LidarPoint& point : scan.points) {
    if (point.ring != ring) continue;
    const Eigen::Vector3f p = point.position;
    point.position = {c * p.x() - s * p.y(), s * p.x() + c * p.y(), p.z()};
  }
}

void lengthen(scan::Scan& scan, int ring, float by) {
  for (scan::LidarPoint& point : scan.points)
    if (point.ring == ring) point.position *= 1 + by / point.position.norm();
}

class LaserAlignmentTest : public ::testing::Test {
 protected:
  using Change = std::function<void(scan::Scan&)>;
  void check(int looks, const Change& change) {
    for (int i = 0; i < looks; ++i) {
      scan_ = drive_.next();
      change(scan_);
      alignment_.check(level_distances(scan_));
    }
  }
  std::vector<int> wrong() const {
    std::vector<int> rings;
    for (std::size_t ring = 0; ring < kMaxLasers; ++ring) {
      if (alignment_.is_wrong(ring)) rings.push_back(static_cast<int>(ring));
    }
    return rings;
  }
  std::vector<std::string> faults() const {
    std::vector<std::string> faults;
    alignment_.add_faults(faults);
    return faults;
  }

  test::DetectionScans drive_;
  scan::Scan scan_;
  LaserAlignment alignment_;
};

TEST_F(LaserAlignmentTest, LasersThatAreRightKeepTheirPoints) {
  check(60, [](scan::Scan&) {});
  EXPECT_THAT(wrong(), IsEmpty());
  EXPECT_THAT(faults(), IsEmpty());
  const std::size_t before = scan_.points.size();
  alignment_.withhold(scan_);
  EXPECT_EQ(scan_.points.size(), before);
}

TEST_F(LaserAlignmentTest, OneThatLooksAsideIsNamedAndWithheldUntilItIsRightAgain) {
  const Change aside = [](scan::Scan& scan) { turn(scan, 8, 3); };
  check(LaserAlignment::kLooks - 1, aside);
  EXPECT_THAT(wrong(), IsEmpty()) << "not yet";
  check(1, aside);
  ASSERT_THAT(wrong(), ElementsAre(8));
  alignment_.withhold(scan_);
  for (const scan::LidarPoint& point : scan_.points) ASSERT_NE(point.ring, 8);
  ASSERT_EQ(faults().size(), 1U);
  EXPECT_THAT(faults()[0], HasSubstr("laser 8 (0: the lowest) looks 3.0 deg to the right of its angle"));
  check(LaserAlignment::kLooks, [](scan::Scan&) {});
  EXPECT_THAT(wrong(), IsEmpty());
}

TEST_F(LaserAlignmentTest, OneWhoseRangesAreWrongIsNamed) {
  check(LaserAlignment::kLooks, [](scan::Scan& scan) { lengthen(scan, 9, -0.2F); });
  ASSERT_THAT(wrong(), ElementsAre(9));
  EXPECT_THAT(faults()[0], HasSubstr("laser 9 (0: the lowest) measures 0.20 m too little"));
  EXPECT_EQ(alignment_.counters()["faults.laser_aligned"], 1);
}

TEST_F(LaserAlignmentTest, IfManyAreWrongAllAreUsedAndAllAreNamed) {
  check(2 * LaserAlignment::kLooks, [](scan::Scan& scan) {
    for (int ring = 0; ring < 16; ring += 2) turn(scan, ring, 3);
  });
  ASSERT_GT(wrong().size(), 4U);
  const std::size_t before = scan_.points.size();
  alignment_.withhold(scan_);
  EXPECT_EQ(scan_.points.size(), before);
  EXPECT_THAT(faults()[0], HasSubstr("is used, as too many are wrong"));
}

}  // namespace
}  // namespace curbstone::mapper::returns
