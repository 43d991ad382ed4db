#include <gtest/gtest.h>

#include "tools/bench/curbs/scenes/hdl64.hpp"
#include "tools/bench/curbs/scores/bin_score.hpp"
#include "tools/bench/curbs/scores/curb_feet.hpp"
#include "tools/detect/cloud_map/cloud_map.hpp"

namespace curbstone::bench::curbs {
namespace {

/// One scan of an HDL-64 that stands at the origin, levelled.
scores::BinScore score_of_scan(const scenes::CurbSceneOptions& options) {
  const scenes::CurbScene scene(options);
  Pose T_world_lidar = scene.T_world_base(0);
  T_world_lidar.translation().z() += 1.9;
  detect::cloud_map::CloudMapOptions method;
  method.range = 30;
  const auto scan = scenes::scan_hdl64(scene.scene(), T_world_lidar, options.noise, 1);
  return scores::score_bins(scores::feet_along(detect::cloud_map::map_cloud(scan, method).lines), scene,
                            {T_world_lidar.translation()});
}

/// Beyond 10 m the scan lines are half a metre to more than a metre apart along the curb.
TEST(SingleScan, OfALowCurbBetweenDistantScanLinesFindsIt) {
  const scores::BinScore six = score_of_scan({.name = "6 cm", .height = 0.06});
  EXPECT_GT(six.f1(), 0.92) << six.precision << " " << six.recall;
  EXPECT_GT(score_of_scan({.name = "8 cm, 3 cm noise", .height = 0.08, .noise = 0.03}).f1(), 0.92);
}

}  // namespace
}  // namespace curbstone::bench::curbs
