#include "tools/simulate/motion/town_route.hpp"

#include <Eigen/LU>
#include <cmath>

namespace curbstone::simulate::motion {

namespace {

using Points = std::vector<Eigen::Vector2d>;

/// Turns from one lane into another that meets it at `corner`: tangent to both, close to an arc.
void turn(Points& points, const Eigen::Vector2d& from, const Eigen::Vector2d& corner, const Eigen::Vector2d& to) {
  constexpr double kHandle = 0.5523;  // handle length of a Bezier curve for a quarter circle
  const Eigen::Vector2d a = from + kHandle * (corner - from), b = to + kHandle * (corner - to);
  const int n = static_cast<int>(0.8 * ((corner - from).norm() + (to - corner).norm()));
  for (int i = 1; i < n; ++i) {
    const double f = static_cast<double>(i) / n, g = 1.0 - f;
    points.push_back(g * g * g * from + 3.0 * g * g * f * a + 3.0 * g * f * f * b + f * f * f * to);
  }
}

/// The intersection of two lanes.
Eigen::Vector2d crossing(const Eigen::Vector2d& p, const Eigen::Vector2d& along_p, const Eigen::Vector2d& q,
                         const Eigen::Vector2d& along_q) {
  Eigen::Matrix2d directions;
  directions << along_p, -along_q;
  return p + along_p * directions.inverse().row(0).dot(q - p);
}

}  // namespace

TownRoute TownRoute::around(const world::Town& town) {
  const world::Street& loop = town.streets.front();
  const auto n = static_cast<int>(loop.length());
  Points points;
  for (int i = -1; i <= n; ++i) {
    const world::Street::Sample at = loop.at(loop.length() * i / n);
    points.emplace_back(at.point + town.options.lane_offset * at.normal());
  }
  return {std::move(points), true};
}

TownRoute TownRoute::there_and_back(const world::Town& town) {
  constexpr double kBegin = 100.0;  // m from the loop
  constexpr double kTurn = 9.0;     // m before and after a corner: 6 m of the curb, and the lane's offset from it
  const world::Street &loop = town.streets.front(), &gate = town.streets.at(1);
  const double lane = town.options.lane_offset;
  const auto on_loop = [&](double s) -> Eigen::Vector2d { return loop.at(s).point + lane * loop.at(s).normal(); };
  const auto on_gate = [&](double s, double side) -> Eigen::Vector2d {
    return gate.at(s).point + side * lane * gate.at(s).normal();
  };
  // Where the gate's crown meets the loop, m along the loop.
  double meets = 0;
  for (const world::Street::Sample& at : loop.samples()) {
    if ((at.point - gate.at(0).point).norm() < (loop.at(meets).point - gate.at(0).point).norm()) meets = at.s;
  }
  const Eigen::Vector2d along_loop = loop.at(meets).tangent, along_gate = gate.at(0).tangent;
  const Eigen::Vector2d corner_in = crossing(on_gate(0, -1), along_gate, on_loop(meets), along_loop);
  const Eigen::Vector2d corner_out = crossing(on_gate(0, 1), along_gate, on_loop(meets), along_loop);

  Points points;
  const auto gate_way = [&](const Eigen::Vector2d& corner) {  // along the gate, to the start of the turn
    return (corner + kTurn * along_gate - gate.at(0).point).dot(along_gate);
  };
  const auto loop_way = [&](const Eigen::Vector2d& corner) {  // along the loop, from where the gate meets it
    return (corner - loop.at(meets).point).dot(along_loop);
  };
  const double in = gate_way(corner_in), out = gate_way(corner_out);
  const double begin = meets + loop_way(corner_in) + kTurn, end = meets + loop.length() + loop_way(corner_out) - kTurn;
  const auto straight_on = [&](double from, double to, const auto& place) {  // equal steps: they set the spline's speed
    const int n = static_cast<int>(std::abs(to - from));
    for (int i = 0; i <= n; ++i) points.push_back(place(from + (to - from) * i / n));
  };
  straight_on(kBegin, in, [&](double s) { return on_gate(s, -1); });
  turn(points, points.back(), corner_in, on_loop(begin));
  straight_on(begin, end, on_loop);
  turn(points, points.back(), corner_out, on_gate(out, 1));
  straight_on(out, kBegin, [&](double s) { return on_gate(s, 1); });
  points.insert(points.begin(), 2.0 * points[0] - points[1]);
  points.push_back(2.0 * points[points.size() - 1] - points[points.size() - 2]);
  return {std::move(points), false};
}

TownRoute TownRoute::along(const world::Town& town) {
  constexpr double kFromEnds = 10.0;  // m
  const world::Street& street = town.streets.front();
  Points points;
  for (double s = kFromEnds - 1; s <= street.length() - kFromEnds + 1; s += 1) {
    const world::Street::Sample at = street.at(s);
    points.emplace_back(at.point + town.options.lane_offset * at.normal());
  }
  return {std::move(points), false};
}

double TownRoute::length() const {
  double length = 0;
  for (int i = 1; i < size() + (closed_ ? 1 : 0); ++i) length += (at(i) - at(i - 1)).norm();
  return length;
}

}  // namespace curbstone::simulate::motion
