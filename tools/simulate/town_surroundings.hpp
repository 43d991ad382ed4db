#pragma once

#include <vector>

#include "tools/simulate/sensors/lidar_noise.hpp"
#include "tools/simulate/sensors/surroundings.hpp"

namespace curbstone::simulate {

/// Casts the lasers' rays into a town, moving cars included.
class TownSurroundings final : public sensors::Surroundings {
 public:
  TownSurroundings(const world::Town& town, const sensors::LidarNoise& noise) : town_(town), noise_(noise) {}

  void prepare(const sensors::PacketView& view) override {
    town_.place_cars(view.t, moving_);
    // What no ray of this packet can meet would be looked at by each.
    const Eigen::Vector3f eye = view.T_world_lidar.translation().cast<float>();
    std::erase_if(moving_, [&](const world::Shape& shape) { return (shape.centre - eye).norm() > kReach + kMargin; });
  }
  [[nodiscard]] devices::LidarShot measure(const sensors::Shot& shot) override {
    const world::Ray ray{shot.origin_world.cast<float>(), shot.direction_world.cast<float>()};
    return noise_.report(town_.scene->cast(ray, kReach, moving_, shot.noise), shot.noise);
  }

 private:
  static constexpr float kReach = 150.0F;  // m
  static constexpr float kMargin = 10.0F;  // m: a car's size, and what the vehicle drives within a packet
  const world::Town& town_;
  sensors::LidarNoise noise_;
  std::vector<world::Shape> moving_;
};

}  // namespace curbstone::simulate
