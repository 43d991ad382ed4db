#include "tools/simulate/world/side_street.hpp"

#include <cmath>

namespace curbstone::simulate::world {

void add_side_street(std::vector<Street>& streets, double s, Side side, double length, numerics::Random& random) {
  const Street::Sample from = streets.front().at(s);
  const Eigen::Vector2d normal = static_cast<double>(static_cast<int>(side)) * from.normal();
  const double turn = random.uniform(-0.12, 0.12);
  const Eigen::Vector2d along(std::cos(turn) * normal.x() - std::sin(turn) * normal.y(),
                              std::sin(turn) * normal.x() + std::cos(turn) * normal.y());
  // Starts at the edge of the loop: from its crown the joining arcs would reach the opposite curb.
  std::vector<Eigen::Vector2d> points;
  for (double d = streets.front().half_width(); d <= length; d += 4.0) points.push_back(from.point + d * along);
  streets.emplace_back(numerics::Spline<Eigen::Vector2d>(points, false), random.uniform(3.2, 3.8));
}

}  // namespace curbstone::simulate::world
