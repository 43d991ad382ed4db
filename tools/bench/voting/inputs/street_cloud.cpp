#include "tools/bench/voting/inputs/street_cloud.hpp"

#include <random>

namespace curbstone::bench::voting::inputs {

std::vector<Eigen::Vector3d> street_cloud(std::size_t points, double length, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> noise(0, 0.01);
  std::vector<Eigen::Vector3d> cloud(points);
  for (Eigen::Vector3d& p : cloud) {
    p.x() = length * (unit(random) - 0.5);
    const double side = unit(random) < 0.5 ? -1 : 1;
    double s = kStreetArea * unit(random);  // along the profile of the street, both sides included
    if (s < 7) {
      p.y() = s - 3.5, p.z() = 0;
    } else if ((s -= 7) < 2 * 0.15) {
      p.y() = 3.5 * side, p.z() = s / 2;
    } else if ((s -= 2 * 0.15) < 2 * 5.5) {
      p.y() = side * (3.5 + s / 2), p.z() = 0.15;
    } else {
      p.y() = 9 * side, p.z() = (s - 2 * 5.5) / 2;
    }
    for (int axis = 0; axis < 3; ++axis) p[axis] += noise(random);
  }
  return cloud;
}

}  // namespace curbstone::bench::voting::inputs
