#include <cmath>
#include <numbers>

#include "tools/simulate/world/side_street.hpp"
#include "tools/simulate/world/town_plan.hpp"

namespace curbstone::simulate::world {

namespace {

using std::numbers::pi;

/// Control points of a street around a block: straight sides, round corners, one or two long sides that curve.
std::vector<Eigen::Vector2d> block(numerics::Random& random) {
  const double width = random.uniform(112.0, 136.0), depth = random.uniform(78.0, 92.0);
  const double radius = random.uniform(15.0, 20.0), step = 5.0;
  std::vector<Eigen::Vector2d> points;
  const auto side = [&](Eigen::Vector2d from, double heading, double length, double swing) {
    const Eigen::Vector2d along(std::cos(heading), std::sin(heading)), left(-along.y(), along.x());
    const int n = static_cast<int>(length / step);
    for (int i = 0; i < n; ++i) {
      const double f = (i + 0.5) / n;
      points.push_back(from + along * (f * length) + left * (swing * std::pow(std::sin(pi * f), 2)));
    }
  };
  const auto corner = [&](Eigen::Vector2d centre, double from) {
    const int n = static_cast<int>(std::ceil(radius * pi / 2.0 / step));
    for (int i = 0; i < n; ++i) {
      const double a = from + pi / 2.0 * (i + 0.5) / n;
      points.push_back(centre + radius * Eigen::Vector2d(std::cos(a), std::sin(a)));
    }
  };
  // Counter-clockwise, from the beginning of the south side.
  const double w = width - 2 * radius, d = depth - 2 * radius;
  const double south = random.uniform(-7.0, -3.0), north = random.uniform(3.0, 8.0);
  side({0, 0}, 0.0, w, south);
  corner({w, radius}, -pi / 2.0);
  side({w + radius, radius}, pi / 2.0, d, 0.0);
  corner({w, radius + d}, 0.0);
  side({w, 2 * radius + d}, pi, w, random.chance(0.5) ? -north : north * 0.6);
  corner({0, radius + d}, pi / 2.0);
  side({-radius, radius + d}, -pi / 2.0, d, random.uniform(-2.0, 2.0));
  corner({0, radius}, pi);
  return points;
}

}  // namespace

TownPlan plan_block(double half_width, numerics::Random& random) {
  TownPlan plan;
  plan.streets.emplace_back(numerics::Spline<Eigen::Vector2d>(block(random), true), half_width);
  const double around = plan.streets.front().length();
  add_side_street(plan.streets, around * random.uniform(0.10, 0.14), Side::kRight, 70.0, random);
  add_side_street(plan.streets, around * random.uniform(0.58, 0.64), Side::kRight, 70.0, random);
  add_side_street(plan.streets, around * random.uniform(0.60, 0.66), Side::kLeft, 24.0, random);
  return plan;
}

}  // namespace curbstone::simulate::world
