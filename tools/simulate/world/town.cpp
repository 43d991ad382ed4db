#include "tools/simulate/world/town.hpp"

#include <cmath>
#include <numbers>

#include "tools/simulate/world/furnish.hpp"
#include "tools/simulate/world/ground_builder.hpp"

namespace curbstone {

namespace {

constexpr double kPi = std::numbers::pi;

/// Control points of a street around a block: straight sides, round corners, one long side or two that swing.
std::vector<Eigen::Vector2d> block(Random& random) {
  const double width = random.uniform(112.0, 136.0), depth = random.uniform(78.0, 92.0);
  const double radius = random.uniform(15.0, 20.0), step = 5.0;
  std::vector<Eigen::Vector2d> points;
  const auto side = [&](Eigen::Vector2d from, double heading, double length, double swing) {
    const Eigen::Vector2d along(std::cos(heading), std::sin(heading)), left(-along.y(), along.x());
    const int n = static_cast<int>(length / step);
    for (int i = 0; i < n; ++i) {
      const double f = (i + 0.5) / n;
      points.push_back(from + along * (f * length) + left * (swing * std::pow(std::sin(kPi * f), 2)));
    }
  };
  const auto corner = [&](Eigen::Vector2d centre, double from) {
    const int n = static_cast<int>(std::ceil(radius * kPi / 2.0 / step));
    for (int i = 0; i < n; ++i) {
      const double a = from + kPi / 2.0 * (i + 0.5) / n;
      points.push_back(centre + radius * Eigen::Vector2d(std::cos(a), std::sin(a)));
    }
  };
  // Counter-clockwise, from the middle of the south side's beginning.
  const double w = width - 2 * radius, d = depth - 2 * radius;
  const double south = random.uniform(-7.0, -3.0), north = random.uniform(3.0, 8.0);
  side({0, 0}, 0.0, w, south);
  corner({w, radius}, -kPi / 2.0);
  side({w + radius, radius}, kPi / 2.0, d, 0.0);
  corner({w, radius + d}, 0.0);
  side({w, 2 * radius + d}, kPi, w, random.chance(0.5) ? -north : north * 0.6);
  corner({0, radius + d}, kPi / 2.0);
  side({-radius, radius + d}, -kPi / 2.0, d, random.uniform(-2.0, 2.0));
  corner({0, radius}, kPi);
  return points;
}

void add_side_street(std::vector<Street>& streets, double s, Side side, double length, Random& random) {
  const Street::Sample from = streets.front().at(s);
  const Eigen::Vector2d normal = static_cast<double>(static_cast<int>(side)) * from.normal();
  const double turn = random.uniform(-0.12, 0.12);
  const Eigen::Vector2d along(std::cos(turn) * normal.x() - std::sin(turn) * normal.y(),
                              std::sin(turn) * normal.x() + std::cos(turn) * normal.y());
  // From the edge of the loop on: from its crown the joining arcs would reach the opposite curb.
  std::vector<Eigen::Vector2d> points;
  for (double d = streets.front().half_width(); d <= length; d += 4.0) points.push_back(from.point + d * along);
  streets.emplace_back(Spline<Eigen::Vector2d>(points, false), random.uniform(3.2, 3.8));
}

void set_curbs(Street& street, Random& random) {
  for (const Side side : {Side::kLeft, Side::kRight}) {
    CurbSide& curb = street.curb(side);
    curb.stretch = random.uniform(22.0, 34.0);
    const int n = std::max(1, static_cast<int>(street.length() / curb.stretch));
    for (int i = 0; i < n; ++i) curb.heights.push_back(random.uniform(0.06, 0.15));
  }
}

}  // namespace

Town::Town(const TownOptions& town_options) : options(town_options) {
  const Random random(options.seed);
  Random plan = random.fork(1);
  StreetProfile profile;
  streets.emplace_back(Spline<Eigen::Vector2d>(block(plan), true), profile.half_width);
  const double around = streets.front().length();
  add_side_street(streets, around * plan.uniform(0.10, 0.14), Side::kRight, 70.0, plan);
  add_side_street(streets, around * plan.uniform(0.58, 0.64), Side::kRight, 70.0, plan);
  add_side_street(streets, around * plan.uniform(0.60, 0.66), Side::kLeft, 24.0, plan);
  for (auto& street : streets) set_curbs(street, plan);

  const Furnishing furnishing = plan_furnishing(streets, random.fork(2));
  for (const auto& drop : furnishing.driveways)
    streets[drop.street].curb(drop.side).dropped.push_back({drop.s, drop.half, drop.height});
  Ground ground = build_ground(streets, profile, random.fork(3));
  std::vector<Shape> shapes = furnish(furnishing, streets, ground, random.fork(4));
  scene = std::make_unique<const Scene>(std::move(ground), std::move(shapes));

  Random traffic = random.fork(5);
  for (int i = 0; i < 4; ++i) {
    cars.push_back(
        {around * (i + traffic.uniform(0.1, 0.9)) / 4.0, traffic.uniform(6.0, 8.0), 1.45, traffic.uniform(0.15, 0.7)});
  }
}

void Town::place_cars(double t, std::vector<Shape>& shapes) const {
  shapes.clear();
  const Street& loop = streets.front();
  for (const auto& car : cars) {
    const Street::Sample at = loop.at(car.start - car.speed * t);
    const Eigen::Vector2d p = at.point + car.lane * at.normal();
    const auto z = static_cast<double>(scene->ground().height_at(static_cast<float>(p.x()), static_cast<float>(p.y())));
    add_car(shapes, {p.x(), p.y(), z}, std::atan2(-at.tangent.y(), -at.tangent.x()),
            static_cast<float>(car.reflectivity));
  }
}

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

}  // namespace curbstone
