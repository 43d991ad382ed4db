#include <gtest/gtest.h>

#include "tools/bench/curbs/bin_score.hpp"
#include "tools/bench/curbs/curb_feet.hpp"
#include "tools/bench/curbs/hdl64.hpp"
#include "tools/detect/cloud_map.hpp"

namespace curbstone {
namespace {

/// One scan of an HDL-64 that stands at the origin, levelled.
BinScore score_of_scan(const CurbSceneOptions& options) {
  const CurbScene scene(options);
  Pose T_world_lidar = scene.T_world_base(0);
  T_world_lidar.translation().z() += 1.9;
  CloudMapOptions method;
  method.range = 30;
  const auto scan = scan_hdl64(scene.scene(), T_world_lidar, options.noise, 1);
  return score_bins(feet_along(map_cloud(scan, method).lines), scene, {T_world_lidar.translation()});
}

/// Beyond 10 m the scan lines are half a metre to more than a metre apart along the curb.
TEST(SingleScan, OfALowCurbBetweenDistantScanLinesFindsIt) {
  const BinScore six = score_of_scan({.name = "6 cm", .height = 0.06});
  EXPECT_GT(six.f1(), 0.92) << six.precision << " " << six.recall;
  EXPECT_GT(score_of_scan({.name = "8 cm, 3 cm noise", .height = 0.08, .noise = 0.03}).f1(), 0.92);
}

}  // namespace
}  // namespace curbstone
