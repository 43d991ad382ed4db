#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "tools/simulate/world/side_street.hpp"
#include "tools/simulate/world/town_plan.hpp"

namespace curbstone::simulate::world {

namespace {

using std::numbers::pi;
constexpr double kCorner = 17.0;             // m, radius of the loop's bends
constexpr double kBetweenCrossings = 115.0;  // m along the loop, approximately

using Points = std::vector<Eigen::Vector2d>;

/// Draws a line leg by leg, as control points about 5 m apart.
class Pen {
 public:
  /// Curves to the side in several bows, and returns to the straight line.
  void go(double length, numerics::Random random) {
    const int bows = std::max(1, static_cast<int>(std::lround(length / 110.0)));
    std::vector<double> swings;
    for (int i = 0; i < bows; ++i) swings.push_back(random.uniform(2.0, 6.0) * (random.chance(0.5) ? 1.0 : -1.0));
    const int n = std::max(1, static_cast<int>(length / 5.0));
    for (int i = 0; i < n; ++i) {
      const double f = (i + 0.5) / n;
      const double bow = f * bows;
      points_.push_back(at_ + along() * (f * length) +
                        left() * (swings[static_cast<std::size_t>(bow)] * std::pow(std::sin(pi * bow), 2)));
    }
    at_ += length * along();
  }
  /// A quarter of a circle; `side` 1 to the left, -1 to the right.
  void turn(double side) {
    const Eigen::Vector2d centre = at_ + side * kCorner * left();
    const Eigen::Vector2d out = at_ - centre;
    const int n = 6;
    for (int i = 0; i < n; ++i) {
      const double a = side * pi / 2.0 * (i + 0.5) / n;
      points_.push_back(centre + Eigen::Rotation2Dd(a) * out);
    }
    at_ = centre + Eigen::Rotation2Dd(side * pi / 2.0) * out;
    heading_ += side * pi / 2.0;
  }
  [[nodiscard]] Points take() { return std::move(points_); }

 private:
  [[nodiscard]] Eigen::Vector2d along() const { return {std::cos(heading_), std::sin(heading_)}; }
  [[nodiscard]] Eigen::Vector2d left() const { return {-std::sin(heading_), std::cos(heading_)}; }
  Eigen::Vector2d at_ = Eigen::Vector2d::Zero();
  double heading_ = 0;
  Points points_;
};

/// An L-shaped loop: east, north, west, north, west, south. `a`..`d`: distances between the corners of the first four
/// legs, m; the last two legs close it.
Points l_shape(double a, double b, double c, double d, const numerics::Random& random) {
  const double r = 2.0 * kCorner;
  Pen pen;
  pen.go(a - r, random.fork(1));
  pen.turn(1);
  pen.go(b - r, random.fork(2));
  pen.turn(1);
  pen.go(c - r, random.fork(3));
  pen.turn(-1);
  pen.go(d - r, random.fork(4));
  pen.turn(1);
  pen.go(a - c - r, random.fork(5));
  pen.turn(1);
  pen.go(b + d - r, random.fork(6));
  pen.turn(1);
  return pen.take();
}

Street make_loop(double round, double half_width, numerics::Random& random) {
  const double a = random.uniform(0.23, 0.25), b = random.uniform(0.12, 0.14), c = random.uniform(0.115, 0.125),
               d = random.uniform(0.12, 0.14);
  const numerics::Random swings = random.fork(1);
  // Bends shorten it and bows lengthen it: a few iterations find the size for the wanted length.
  double size = round;
  for (int i = 0;; ++i) {
    const numerics::Spline<Eigen::Vector2d> line(l_shape(a * size, b * size, c * size, d * size, swings), true);
    Street loop(line, half_width);
    if (i == 4) return loop;
    size *= round / loop.length();
  }
}

/// Whether the loop is straight for `half` m before and after s.
bool straight(const Street& loop, double s, double half) {
  return loop.at(s - half).tangent.dot(loop.at(s + half).tangent) > std::cos(0.35);
}

/// A street across the blocks from a place on the loop to where it meets the loop again at about a right angle.
std::optional<Street> street_across(const Street& loop, double s, double half_width, numerics::Random& random) {
  const Street::Sample from = loop.at(s);
  const Eigen::Vector2d along = Eigen::Rotation2Dd(random.uniform(-0.05, 0.05)) * from.normal();
  for (double way = 50.0; way < 1500.0; way += 1.0) {
    const Eigen::Vector2d p = from.point + way * along;
    const auto& samples = loop.samples();
    const auto nearest = std::min_element(samples.begin(), samples.end(), [&](const auto& u, const auto& v) {
      return (u.point - p).squaredNorm() < (v.point - p).squaredNorm();
    });
    if ((nearest->point - p).norm() > loop.half_width()) continue;
    if (std::abs(nearest->tangent.dot(along)) > 0.3 || !straight(loop, nearest->s, 22.0)) return std::nullopt;
    Points points;
    const auto n = static_cast<int>((way - loop.half_width()) / 4.0);
    for (int i = 0; i <= n; ++i)
      points.push_back(from.point + along * (loop.half_width() + (way - loop.half_width()) * i / n));
    return Street(numerics::Spline<Eigen::Vector2d>(points, false), half_width);
  }
  return std::nullopt;
}

/// Whether any street comes nearer than `apart` to a place.
bool near(const std::vector<Street>& streets, const Eigen::Vector2d& place, double apart) {
  return std::any_of(streets.begin() + 1, streets.end(), [&](const Street& street) {
    return std::any_of(street.samples().begin(), street.samples().end(),
                       [&](const Street::Sample& at) { return (at.point - place).norm() < apart; });
  });
}

/// The building styles: suburb, terraces, villas, a park and blocks of flats.
Quarter quarter_of(int kind) {
  Quarter quarter;
  switch (kind) {
    case 1:
      quarter.plot = {10.5, 12.5};
      quarter.width = {8.5, 9.5};
      quarter.height = {8.0, 10.0};
      quarter.setback = {3.4, 4.2};
      quarter.fences = quarter.fences_and_hedges = 0.1;
      quarter.garden_trees = 0.0;
      quarter.parking = 1.6;
      quarter.between_trees = {30.0, 50.0};
      break;
    case 2:
      quarter.plot = {22.0, 32.0};
      quarter.width = {12.0, 17.0};
      quarter.height = {6.0, 8.0};
      quarter.setback = {8.0, 14.0};
      quarter.fences = 0.2;
      quarter.fences_and_hedges = 0.95;
      quarter.garden_trees = 1.0;
      quarter.parking = 0.4;
      quarter.between_trees = {12.0, 18.0};
      break;
    case 3:
      quarter.houses = 0.12;
      quarter.fences = 0.15;
      quarter.fences_and_hedges = 0.25;
      quarter.garden_trees = 1.0;
      quarter.parking = 0.3;
      quarter.between_trees = {7.0, 12.0};
      break;
    case 4:
      quarter.plot = {28.0, 40.0};
      quarter.width = {20.0, 30.0};
      quarter.height = {9.0, 14.0};
      quarter.setback = {5.0, 11.0};
      quarter.fences = 0.1;
      quarter.fences_and_hedges = 0.3;
      quarter.garden_trees = 0.8;
      quarter.parking = 2.0;
      break;
    default:
      break;
  }
  return quarter;
}

/// Stretches of 60 to 90 m, each in another style than the one before.
Quarters::Row row_of_quarters(double length, numerics::Random& random) {
  Quarters::Row row;
  const int n = std::max(1, static_cast<int>(length / random.uniform(60.0, 90.0)));
  row.stretch = length / n;
  int kind = random.integer(0, 4);
  for (int i = 0; i < n; ++i) {
    row.quarters.push_back(quarter_of(kind));
    kind = (kind + random.integer(1, 4)) % 5;
  }
  return row;
}

}  // namespace

TownPlan plan_blocks(double round, double half_width, numerics::Random& random) {
  TownPlan plan;
  plan.streets.push_back(make_loop(round, half_width, random));
  const Street loop = plan.streets.front();
  // The way in and out, off the first leg.
  const double gate = round * random.uniform(0.10, 0.12);
  {
    const Street::Sample from = loop.at(gate);
    Points points;
    for (double d = loop.half_width(); d <= 116.0; d += 4.0) points.push_back(from.point - d * from.normal());
    plan.streets.emplace_back(numerics::Spline<Eigen::Vector2d>(points, false), half_width);
  }
  plan.inside = 2;
  for (double s = random.uniform(30.0, 60.0); s < loop.length() - 30.0;
       s += kBetweenCrossings * random.uniform(0.8, 1.2)) {
    if (!straight(loop, s, 22.0) || near(plan.streets, loop.at(s).point, 45.0)) continue;
    if (random.chance(0.6)) {
      if (auto across = street_across(loop, s, random.uniform(3.2, 3.8), random)) {
        if (!near(plan.streets, across->samples().back().point, 45.0)) plan.streets.push_back(std::move(*across));
        continue;
      }
    }
    add_side_street(plan.streets, s, Side::kRight, 70.0, random);
  }
  for (const Street& street : plan.streets) plan.quarters.rows.push_back(row_of_quarters(street.length(), random));
  return plan;
}

}  // namespace curbstone::simulate::world
