#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tools/bench/curbs/scenes/curb_scene.hpp"
#include "tools/bench/curbs/scenes/hdl64.hpp"

namespace curbstone::bench::curbs::scenes {
namespace {

TEST(CurbScene, PlacesAlongTheRoadAndBack) {
  for (const double curvature : {0.0, 0.05, -0.02}) {
    const CurbScene scene({.name = "bend", .curvature = curvature});
    for (const double s : {-3.0, 0.0, 7.0, 18.0}) {
      for (const double y : {-3.0, 0.0, 5.0}) {
        const Eigen::Vector3d at = scene.place(s, y);
        const Eigen::Vector2d back = scene.along_road(at.x(), at.y());
        EXPECT_NEAR(back.x(), s, 1e-6) << curvature;
        EXPECT_NEAR(back.y(), y, 1e-6) << curvature;
      }
    }
  }
}

TEST(CurbScene, HasACurbOfItsHeightAtItsFoot) {
  for (const CurbSceneOptions& options : peer_scenes()) {
    const CurbScene scene(options);
    const double low = scene.place(10, options.left - 0.01).z();
    const double high = scene.place(10, options.left + 0.10).z();
    EXPECT_NEAR(high - low, options.height, 0.005) << options.name;
  }
}

TEST(CurbScene, WithoutACurbIsFlushAtTheRoadsEdgeWhereItsGrassBegins) {
  const CurbSceneOptions options{.name = "country road", .height = 0, .pavement = 0.15, .tufts = 0.06};
  const CurbScene scene(options);
  EXPECT_FALSE(scene.has_curbs());
  EXPECT_NEAR(scene.place(10, options.left + 0.10).z(), scene.place(10, options.left - 0.01).z(), 0.005);
  float highest = 0;
  for (float x = 5; x < 10; x += 0.05F) {
    const float y = static_cast<float>(options.left) + 1.0F;
    const simulate::world::Ground& ground = scene.scene().ground();
    const float tuft = ground.height_at(x, y, true) - ground.height_at(x, y);
    EXPECT_GE(tuft, 0);
    highest = std::max(highest, tuft);
  }
  EXPECT_GT(highest, 0.04F);
  EXPECT_LE(highest, 0.06F);
}

TEST(CurbScene, KnowsWhatParkedCarsHide) {
  const CurbScene open({.name = "open"});
  const CurbScene parked({.name = "parked", .parked_cars = true});
  const Eigen::Vector3d eye(0, 0, 1.8);
  int seen = 0;
  for (double s = 1; s < 20; s += 0.5) {
    EXPECT_TRUE(open.sees_curb(eye, s, 1)) << s;
    seen += parked.sees_curb(eye, s, 1) ? 1 : 0;
  }
  EXPECT_GT(seen, 2);
  EXPECT_LT(seen, 30);
}

TEST(Hdl64, SeesRoadCurbAndHousesWithItsNoise) {
  const CurbScene scene({.name = "street", .noise = 0.01});
  Pose T_world_lidar = scene.T_world_base(0);
  T_world_lidar.translation().z() += 1.73;
  const auto points = scan_hdl64(scene.scene(), T_world_lidar, 0.01, 1);
  EXPECT_GT(points.size(), 90'000U);
  double lowest = 0;
  for (const Eigen::Vector3f& p : points) lowest = std::min(lowest, static_cast<double>(p.z()));
  EXPECT_NEAR(lowest, -1.73, 0.15);
  EXPECT_EQ(points, scan_hdl64(scene.scene(), T_world_lidar, 0.01, 1)) << "the same seed, the same scan";
}

}  // namespace
}  // namespace curbstone::bench::curbs::scenes
