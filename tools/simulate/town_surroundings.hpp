#pragma once

#include <vector>

#include "tools/simulate/paint/painted_ground.hpp"
#include "tools/simulate/sensors/intensity_model.hpp"
#include "tools/simulate/sensors/lidar_noise.hpp"
#include "tools/simulate/sensors/surroundings.hpp"

namespace curbstone::simulate {

/// Casts the lasers' rays into a town, including moving cars. Paint on the ground affects only the intensity of a
/// return.
class TownSurroundings final : public sensors::Surroundings {
 public:
  TownSurroundings(const world::Town& town, const sensors::LidarNoise& noise) : town_(town), noise_(noise) {}
  TownSurroundings(const world::Town& town, const sensors::LidarNoise& noise, const paint::PaintedGround& ground,
                   const sensors::IntensityModel& intensity)
      : town_(town), noise_(noise), ground_(&ground), intensity_(intensity) {}

  void prepare(const sensors::PacketView& view) override {
    town_.place_cars(view.t, moving_);
    // Skips cars that no ray of this packet can hit.
    const Eigen::Vector3f eye = view.T_world_lidar.translation().cast<float>();
    std::erase_if(moving_, [&](const world::Shape& shape) { return (shape.centre - eye).norm() > kReach + kMargin; });
  }
  [[nodiscard]] devices::LidarShot measure(const sensors::Shot& shot) override {
    const world::Ray ray{shot.origin_world.cast<float>(), shot.direction_world.cast<float>()};
    const world::Hit hit = town_.scene->cast(ray, kReach, moving_, shot.noise);
    devices::LidarShot report = noise_.report(hit, shot.noise);
    if (ground_ != nullptr && report.range_m > 0)
      report.intensity = intensity_.report(hit, ground_->reflectivity(ray, hit), shot.laser, shot.noise);
    return report;
  }

 private:
  static constexpr float kReach = 150.0F;  // m
  static constexpr float kMargin = 10.0F;  // m: the size of a car, and the vehicle's motion within a packet
  const world::Town& town_;
  sensors::LidarNoise noise_;
  const paint::PaintedGround* ground_ = nullptr;
  sensors::IntensityModel intensity_;
  std::vector<world::Shape> moving_;
};

}  // namespace curbstone::simulate
