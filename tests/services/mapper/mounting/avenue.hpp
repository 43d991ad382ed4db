#pragma once

#include <Eigen/Core>
#include <random>

#include "tests/services/mapper/mapper_drive.hpp"

namespace curbstone::test {

/// Crowns of trees beside a way along x, from 10 m behind to `length`, m: nothing that a plane fits.
inline SyntheticWorld avenue(double length = 25) {
  SyntheticWorld world = plain();
  std::mt19937 engine(4);
  const auto draw = [&](double from, double to) { return std::uniform_real_distribution<double>(from, to)(engine); };
  for (int i = 0; i < static_cast<int>(120 * (length + 10) / 35); ++i) {
    const double side = i % 2 == 0 ? 1.0 : -1.0;
    const double x = draw(-10, length), y = side * draw(5, 9), z = draw(1.5, 5);
    world.boxes.push_back({{x, y, z}, Eigen::Vector3d(x, y, z) + Eigen::Vector3d::Constant(draw(0.3, 0.8))});
  }
  return world;
}

}  // namespace curbstone::test
