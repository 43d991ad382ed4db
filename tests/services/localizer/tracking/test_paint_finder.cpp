#include "services/localizer/tracking/paint_finder.hpp"

#include <gtest/gtest.h>

#include <random>

namespace curbstone::localizer::tracking {
namespace {

using mapper::scan::LidarPoint;

/// Two rings on the road around the vehicle. One gives asphalt 20, the other 60 of 255; paint is twice as bright.
class RoadBelow {
 public:
  [[nodiscard]] std::vector<LidarPoint> look() {
    std::vector<LidarPoint> points;
    for (int i = 0; i < 1800; ++i) {
      const double azimuth = i * 2 * M_PI / 1800;
      for (const int ring : {0, 1}) {
        const double radius = 6 + 3 * ring;
        LidarPoint point;
        point.ring = static_cast<std::uint8_t>(ring);
        point.position =
            Eigen::Vector2d(radius * std::cos(azimuth), radius * std::sin(azimuth)).cast<float>().homogeneous();
        point.position.z() = 0;
        const double level = (ring == 0 ? 20 : 60) * (is_paint(point) ? 2.0 : 1.0) + noise_(random_);
        point.intensity = static_cast<std::uint8_t>(std::clamp(level, 1.0, 255.0));
        points.push_back(point);
      }
    }
    return points;
  }
  [[nodiscard]] static bool is_paint(const LidarPoint& point) { return std::abs(point.position.y() - 2.0F) < 0.1F; }

 private:
  std::mt19937 random_{1};
  std::normal_distribution<double> noise_{0, 2};
};

Pose driven(double x) {
  Pose pose = Pose::Identity();
  pose.translation().x() = x;
  return pose;
}

TEST(PaintFinder, FindsWhatIsBrightForItsRingOnceItKnowsTheRoad) {
  RoadBelow road;
  PaintFinder finder;
  EXPECT_TRUE(finder.find(road.look(), driven(0)).empty()) << "of no ring is the road known yet";
  for (int i = 1; i < 20; ++i) (void)finder.find(road.look(), driven(0.5 * i));
  const auto scan = road.look();
  const auto found = finder.find(scan, driven(10));
  const auto paint = std::count_if(scan.begin(), scan.end(), RoadBelow::is_paint);
  const auto right =
      std::count_if(found.begin(), found.end(), [](const Eigen::Vector3d& p) { return std::abs(p.y() - 2) < 0.1; });
  EXPECT_GT(right, 0.9 * static_cast<double>(paint));
  EXPECT_LT(static_cast<double>(found.size()) - static_cast<double>(right), 0.02 * static_cast<double>(scan.size()));
}

TEST(PaintFinder, LeavesOutWhatIsTooLongForPaintAndGroundThatIsBrightAllOver) {
  RoadBelow road;
  PaintFinder finder;
  for (int i = 0; i < 20; ++i) (void)finder.find(road.look(), driven(0.5 * i));
  auto scan = road.look();
  for (LidarPoint& point : scan) {
    if (point.position.y() < -3) point.intensity = 200;  // a lawn
  }
  for (const Eigen::Vector3d& p : finder.find(scan, driven(10))) EXPECT_GT(p.y(), -3.1) << p.transpose();
  for (LidarPoint& point : scan) point.intensity = 255;
  EXPECT_TRUE(finder.find(scan, driven(11)).empty());
}

TEST(PaintFinder, LooksOnlyAtTheGroundNearby) {
  RoadBelow road;
  PaintFinder finder;
  for (int i = 0; i < 20; ++i) (void)finder.find(road.look(), driven(0.5 * i));
  const auto scan = road.look();
  EXPECT_FALSE(finder.find(scan, driven(10)).empty());
  auto high = scan, far = scan;
  for (LidarPoint& point : high) point.position.z() = 1;
  for (LidarPoint& point : far) point.position.x() += 30;
  EXPECT_TRUE(finder.find(high, driven(11)).empty());
  EXPECT_TRUE(finder.find(far, driven(12)).empty());
}

}  // namespace
}  // namespace curbstone::localizer::tracking
