#include "services/viewer/scan.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace curbstone::viewer {
namespace {

lidar_points_t packet(std::int32_t revolution, std::vector<float> x) {
  lidar_points_t message{};
  message.revolution = revolution;
  message.num_points = static_cast<std::int32_t>(x.size());
  message.y.assign(x.size(), 0);
  message.z.assign(x.size(), 0);
  message.intensity.assign(x.size(), 9);
  message.x = std::move(x);
  return message;
}

TEST(ScanTest, ShowsTheLastWholeRevolutionInBaseLink) {
  Pose T_base_lidar = Pose::Identity();
  T_base_lidar.translation().z() = 1.73;
  Scan scan(T_base_lidar, 100);
  scan.put(packet(1, {1, 2}));
  scan.put(packet(1, {3}));
  EXPECT_TRUE(scan.points().empty());
  scan.put(packet(2, {4}));
  ASSERT_EQ(scan.points().size(), 3U);
  EXPECT_EQ(scan.points()[2].x, 300);
  EXPECT_EQ(scan.points()[2].z, 173);
  EXPECT_EQ(scan.points()[2].intensity, 9);
}

TEST(ScanTest, KeepsToItsBudget) {
  Scan scan(Pose::Identity(), 100);
  for (int revolution = 0; revolution < 3; ++revolution) scan.put(packet(revolution, std::vector<float>(5000, 1)));
  EXPECT_LE(scan.points().size(), 100U);
  EXPECT_GE(scan.points().size(), 95U);
}

TEST(ScanTest, LeavesOutWhatIsFarOrNoNumberAndRefusesWhatDoesNotAddUp) {
  Scan scan(Pose::Identity(), 100);
  EXPECT_TRUE(scan.put(packet(1, {NAN, 1, 1e9F, INFINITY, -319})));
  scan.put(packet(2, {}));
  EXPECT_EQ(scan.points().size(), 2U);
  lidar_points_t bad = packet(3, {1, 2});
  bad.y.pop_back();
  EXPECT_FALSE(scan.put(bad));
}

}  // namespace
}  // namespace curbstone::viewer
