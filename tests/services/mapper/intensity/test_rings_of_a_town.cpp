#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "services/mapper/intensity/ring_scale.hpp"
#include "tools/simulate/devices/make_lidar.hpp"
#include "tools/simulate/numerics/random.hpp"
#include "tools/simulate/town_setup.hpp"
#include "tools/simulate/town_surroundings.hpp"

namespace curbstone::mapper::intensity {
namespace {

/// An RS16 whose lasers have scales of their own, driven through a painted town without an error of the pose.
class RingsOfATown : public testing::Test {
 protected:
  struct Return {
    scan::LidarPoint point;  // base_link
    float reflectivity;      // of what was met; 0: not the road
  };

  std::vector<Return> scan_at(double t) {
    simulate::TownSurroundings world(town_.town(), town_.config().lidar, town_.ground(), town_.config().intensity);
    const Pose T_base_lidar = town_.config().vehicle.T_base_lidar();
    const Pose T_world_lidar = town_.motion().T_world_base(t) * T_base_lidar;
    world.prepare({t, T_world_lidar, 0, 0});
    std::vector<Return> returns;
    for (int step = 0; step < 900; ++step) {
      const double azimuth = 2 * std::numbers::pi * step / 900;
      for (int laser = 0; laser < 16; ++laser) {
        const double up = elevations_[static_cast<std::size_t>(laser)] * std::numbers::pi / 180;
        const Eigen::Vector3d way(std::cos(up) * std::cos(azimuth), -std::cos(up) * std::sin(azimuth), std::sin(up));
        const simulate::sensors::Shot shot{t,
                                           laser,
                                           azimuth,
                                           T_world_lidar.translation(),
                                           T_world_lidar.linear() * way,
                                           simulate::numerics::mix_bits(++shots_)};
        const auto report = world.measure(shot);
        if (report.range_m <= 0) continue;
        const auto hit = town_.town().scene->cast({shot.origin_world.cast<float>(), shot.direction_world.cast<float>()},
                                                  100.0F, {}, shot.noise);
        const Eigen::Vector3d met = shot.origin_world + static_cast<double>(hit.range) * shot.direction_world;
        const float bright =
            hit.surface != simulate::world::Surface::kAsphalt
                ? 0.0F
                : town_.ground().at(static_cast<float>(met.x()), static_cast<float>(met.y()), hit.surface);
        const Eigen::Vector3d in_base = T_base_lidar * (static_cast<double>(report.range_m) * way);
        returns.push_back({{in_base.cast<float>(), 0, report.intensity, static_cast<std::uint8_t>(laser)}, bright});
      }
    }
    return returns;
  }
  void learn(int scans) {
    for (int i = 0; i < scans; ++i) {
      const double t = 5.0 + 0.1 * i;
      std::vector<scan::LidarPoint> points;
      for (const Return& r : scan_at(t)) points.push_back(r.point);
      scale_.learn(points, town_.motion().T_world_base(t));
    }
  }

  simulate::TownSetup town_{1, 60, 1'750'000'000'000'000};
  std::vector<double> elevations_ =
      simulate::devices::make_lidar(simulate::devices::LidarName::kRs16, 1200)->elevations_deg();
  RingScale scale_;
  std::uint64_t shots_ = 0;
};

int median(std::vector<int> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

TEST_F(RingsOfATown, AgreeOnTheRoadAndSeeItsPaint) {
  learn(80);
  std::map<int, std::vector<int>> raw, road, paint;
  for (double t = 15; t < 40; t += 1.0) {  // elsewhere
    for (const Return& r : scan_at(t)) {
      const int value = scale_.table()->of(r.point.ring, r.point.intensity);
      if (value == 0 || r.point.position.head<2>().norm() > 20) continue;
      if (r.reflectivity > 0.5F) {
        paint[r.point.ring].push_back(value);
      } else if (r.reflectivity > 0.08F) {
        raw[r.point.ring].push_back(r.point.intensity);
        road[r.point.ring].push_back(value);
      }
    }
  }
  ASSERT_GE(road.size(), 5U);
  int lowest = 255, highest = 0;
  for (const auto& [ring, values] : road) {
    ASSERT_GT(values.size(), 1000U) << ring;
    EXPECT_NEAR(median(values), 64, 4) << "ring " << ring;
    lowest = std::min(lowest, median(raw[ring]));
    highest = std::max(highest, median(raw[ring]));
    if (paint[ring].size() <= 50) continue;
    EXPECT_GT(median(paint[ring]), 64 + 40) << "ring " << ring;
  }
  EXPECT_LT(lowest, 20) << "without a scale they do not agree";
  EXPECT_GT(highest, 70);
}

}  // namespace
}  // namespace curbstone::mapper::intensity
