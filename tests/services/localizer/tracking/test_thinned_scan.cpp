#include "services/localizer/tracking/thinned_scan.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace curbstone::localizer::tracking {
namespace {

std::vector<mapper::scan::LidarPoint> points(const std::vector<Eigen::Vector3f>& positions) {
  std::vector<mapper::scan::LidarPoint> all;
  for (const Eigen::Vector3f& position : positions) all.push_back({position, 0, 0, 0});
  return all;
}

TEST(ScanThinner, TakesTheMeanOfABoxAndKeepsBoxesApart) {
  ScanThinner thinner;
  const auto first = thinner.thin(points({{1.01F, 1.01F, 0}, {1.05F, 1.03F, 0.02F}, {1.01F, 1.01F, 1}, {5, 5, 0}}));
  ASSERT_EQ(first.size(), 3U);
  EXPECT_NEAR(first[0].x(), 1.03, 1e-6);
  EXPECT_NEAR(first[0].z(), 0.01, 1e-6);
  EXPECT_EQ(thinner.thin(points({{1.01F, 1.01F, 0}})).size(), 1U) << "nothing is left of the revolution before";
}

TEST(ScanThinner, LeavesOutWhatIsNowhereOrOutOfReach) {
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();
  ScanThinner thinner;
  EXPECT_TRUE(thinner.thin(points({{kNaN, 0, 0}, {0, kInf, 0}, {0, 0, kNaN}, {31, 0, 0}, {0, 0, 1e30F}})).empty());
}

}  // namespace
}  // namespace curbstone::localizer::tracking
