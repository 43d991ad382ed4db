#include "tools/simulate/world/car.hpp"

#include <cmath>

namespace curbstone::simulate::world {

void add_car(std::vector<Shape>& shapes, const Eigen::Vector3d& ground, double yaw, float reflectivity) {
  const Eigen::Vector3d along(std::cos(yaw), std::sin(yaw), 0), left(-along.y(), along.x(), 0);
  const auto up = [](double z) { return Eigen::Vector3d(0, 0, z); };
  shapes.push_back(make_box(Surface::kCar, reflectivity, ground + up(0.54), {4.25, 1.76, 0.64}, yaw));
  shapes.push_back(
      make_box(Surface::kCar, 0.6F * reflectivity, ground - 0.25 * along + up(1.14), {2.3, 1.50, 0.60}, yaw));
  for (const double x : {-1.3, 1.3}) {
    for (const double y : {-0.76, 0.76})
      shapes.push_back(
          make_box(Surface::kCar, 0.06F, ground + x * along + y * left + up(0.31), {0.60, 0.20, 0.62}, yaw));
  }
}

}  // namespace curbstone::simulate::world
