#include "tools/bench/curbs/scenes/hdl64.hpp"

#include <cmath>
#include <numbers>

#include "tools/simulate/numerics/random.hpp"
#include "tools/simulate/sensors/lidar_noise.hpp"

namespace curbstone::bench::curbs::scenes {

namespace {

constexpr int kBeams = 64;
constexpr int kColumns = 2083;
constexpr float kHdlReach = 100.0F;  // m

double elevation(int beam) {
  const double degrees = beam < 32 ? 2.0 - beam / 3.0 : -8.83 - (beam - 32) * 0.5;
  return degrees * std::numbers::pi / 180;
}

}  // namespace

std::vector<Eigen::Vector3f> scan_hdl64(const simulate::world::Scene& scene, const Pose& T_world_lidar, double noise,
                                        std::uint64_t seed) {
  const simulate::sensors::LidarNoise errors{.range_sigma = noise, .min_range = 0.9};
  const Eigen::Vector3f origin = T_world_lidar.translation().cast<float>();
  std::vector<Eigen::Vector3f> points;
  for (int beam = 0; beam < kBeams; ++beam) {
    for (int column = 0; column < kColumns; ++column) {
      const double azimuth = 2 * std::numbers::pi * column / kColumns;
      const Eigen::Vector3d direction(std::cos(elevation(beam)) * std::cos(azimuth),
                                      std::cos(elevation(beam)) * std::sin(azimuth), std::sin(elevation(beam)));
      const auto shot = static_cast<std::uint64_t>(beam * kColumns + column);
      const std::uint64_t bits = simulate::numerics::mix_bits(simulate::numerics::mix_bits(seed) ^ shot);
      const simulate::world::Ray ray{origin, (T_world_lidar.linear() * direction).cast<float>()};
      const simulate::devices::LidarShot report = errors.report(scene.cast(ray, kHdlReach, {}, bits), bits);
      if (report.range_m > 0) points.push_back(report.range_m * direction.cast<float>());
    }
  }
  return points;
}

}  // namespace curbstone::bench::curbs::scenes
