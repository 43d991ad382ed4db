#include "services/semantic_map/curb_lines/curb_lines.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace curbstone::semantic_map::curb_lines {
namespace {

constexpr double kCell = 0.12;  // m: a curb point a cell, as the map has them

/// A place on a curve and which way it runs there.
struct OnCurve {
  Eigen::Vector2d at;
  Eigen::Vector2d along;
};
using Curve = std::function<OnCurve(double s)>;

Curve straight(Eigen::Vector2d from, double heading) {
  const Eigen::Vector2d along(std::cos(heading), std::sin(heading));
  return [=](double s) { return OnCurve{from + s * along, along}; };
}
/// Bends to the left about the point (0, radius).
Curve arc(double radius) {
  return [=](double s) {
    return OnCurve{{radius * std::sin(s / radius), radius - radius * std::cos(s / radius)},
                   {std::cos(s / radius), std::sin(s / radius)}};
  };
}
/// Left, then as far right.
Curve s_bend(double radius, double length) {
  return [=](double s) {
    if (s <= length) return arc(radius)(s);
    const OnCurve middle = arc(radius)(length);
    const OnCurve back = arc(radius)(length - (s - length));
    const OnCurve turned{2 * middle.at - back.at, back.along};
    return turned;
  };
}

/// Curb points along a curve from s = 0 to `length`, the higher side on the right, off by 1 cm as mapped ones are.
class CurbPoints {
 public:
  explicit CurbPoints(unsigned seed = 1, double noise = 0.01) : random_(seed), noise_(0, noise) {}

  CurbPoints& along(const Curve& curve, double from, double to, double height = 0.12) {
    for (double s = from; s < to + 1e-9; s += kCell) {
      const OnCurve c = curve(s);
      const Eigen::Vector2d up(c.along.y(), -c.along.x());
      points.push_back({c.at + noise_(random_) * up + 0.5 * noise_(random_) * c.along, up, 0.5 * noise_(random_),
                        height + 0.3 * noise_(random_), 0.8, height < 0.038, 0.25});
    }
    return *this;
  }
  [[nodiscard]] std::vector<tile::CurbLine> lines() const { return link_curbs(points); }

  std::vector<MapCurbPoint> points;

 private:
  std::mt19937 random_;
  std::normal_distribution<double> noise_;
};

Eigen::Vector2d place(const tile::CurbVertex& v) {
  return {double{v.x}, double{v.y}};
}

double length_of(const tile::CurbLine& line) {
  double sum = 0;
  for (std::size_t k = 1; k < line.points.size(); ++k)
    sum += (place(line.points[k]) - place(line.points[k - 1])).norm();
  return sum;
}

/// Every vertex lies on the curve and its high side is the curve's normal there.
void expect_on(const Curve& curve, double length, const tile::CurbLine& line, double tolerance) {
  for (const tile::CurbVertex& v : line.points) {
    OnCurve nearest = curve(0);
    for (double s = 0; s <= length; s += 0.005) {
      if ((curve(s).at - place(v)).norm() < (nearest.at - place(v)).norm()) nearest = curve(s);
    }
    const Eigen::Vector2d up(nearest.along.y(), -nearest.along.x());
    EXPECT_LT(std::abs((place(v) - nearest.at).dot(up)), tolerance) << place(v).transpose();
    EXPECT_GT(up.dot(Eigen::Vector2d(double{v.high_side_x}, double{v.high_side_y})), std::cos(0.10));
    EXPECT_NEAR(double{v.height}, 0.12, 0.01);
  }
}

TEST(CurbLines, AStraightCurbIsOneLineAlongItsFoot) {
  for (const double heading : {0.0, 0.5, 2.0, -1.2}) {
    const Curve curve = straight({100, -50}, heading);
    const auto lines = CurbPoints().along(curve, 0, 12).lines();
    ASSERT_EQ(lines.size(), 1U);
    expect_on(curve, 12, lines[0], 0.012);
    EXPECT_NEAR(length_of(lines[0]), 12, 0.15);
    EXPECT_FALSE(lines[0].dropped);
    EXPECT_NEAR(double{lines[0].confidence}, 0.8, 0.02);
  }
}

TEST(CurbLines, BendsKeepTheirShape) {
  for (const double radius : {4.0, 8.0, 30.0}) {
    const double length = 0.5 * std::numbers::pi * std::min(radius, 8.0);
    const auto lines = CurbPoints().along(arc(radius), 0, length).lines();
    ASSERT_EQ(lines.size(), 1U) << radius;
    expect_on(arc(radius), length, lines[0], 0.02);
  }
  const auto lines = CurbPoints().along(s_bend(6, 5), 0, 10).lines();
  ASSERT_EQ(lines.size(), 1U);
  expect_on(s_bend(6, 5), 10, lines[0], 0.02);
}

TEST(CurbLines, ManyPointsTellMoreThanOne) {
  const Curve curve = straight({0, 0}, 0);
  CurbPoints once(7, 0.02);
  CurbPoints often(7, 0.02);
  once.along(curve, 0, 15);
  for (int k = 0; k < 4; ++k) often.along(curve, 0, 15);
  const auto rms = [](const std::vector<tile::CurbLine>& lines) {
    double sum = 0;
    for (const tile::CurbVertex& v : lines.at(0).points) sum += double{v.y} * double{v.y};
    return std::sqrt(sum / static_cast<double>(lines[0].points.size()));
  };
  EXPECT_LT(rms(once.lines()), 0.012) << "below the 2 cm of its points";
  EXPECT_LT(rms(often.lines()), 0.8 * rms(once.lines()));
}

TEST(CurbLines, AStrayPointHardlyBendsTheLine) {
  CurbPoints points;
  const Curve curve = straight({0, 0}, 0);
  points.along(curve, 0, 8);
  points.points[30].foot.y() += 0.11;
  const auto lines = points.lines();
  ASSERT_EQ(lines.size(), 1U);
  expect_on(curve, 8, lines[0], 0.02);
}

TEST(CurbLines, AGapIsBridgedIfBothEndsPointAcrossIt) {
  const Curve curve = straight({0, 0}, 0.3);
  const auto whole = CurbPoints().along(curve, 0, 14).lines();
  const auto bridged = CurbPoints().along(curve, 0, 6).along(curve, 8, 14).lines();
  ASSERT_EQ(bridged.size(), 1U);
  expect_on(curve, 14, bridged[0], 0.02);
  EXPECT_LT(bridged[0].confidence, whole[0].confidence - 0.05F) << "a bridge is less certain";

  EXPECT_EQ(CurbPoints().along(curve, 0, 6).along(curve, 9, 14).lines().size(), 2U) << "too far";
  EXPECT_EQ(CurbPoints().along(curve, 0, 6).along(straight({7.5, 2.9}, 0.3), 0, 6).lines().size(), 2U) << "set off";
  EXPECT_EQ(CurbPoints().along(curve, 0, 6).along(straight(curve(8).at, 0.9), 0, 6).lines().size(), 2U) << "turned";
  EXPECT_EQ(CurbPoints().along(curve, 0, 6, 0.05).along(curve, 8, 14, 0.15).lines().size(), 2U) << "another height";
  EXPECT_EQ(CurbPoints().along(curve, 0, 6).along(curve, 8, 9).lines().size(), 2U) << "shorter than the gap";
}

TEST(CurbLines, ADroppedKerbIsAPieceOfItsOwn) {
  const Curve curve = straight({0, 0}, 0);
  const auto lines = CurbPoints().along(curve, 0, 5).along(curve, 5.12, 8.5, 0.025).along(curve, 8.62, 14).lines();
  ASSERT_EQ(lines.size(), 3U);
  EXPECT_FALSE(lines[0].dropped);
  EXPECT_TRUE(lines[1].dropped);
  EXPECT_FALSE(lines[2].dropped);
  EXPECT_EQ(lines[0].points.back(), lines[1].points.front()) << "they meet";
  EXPECT_EQ(lines[1].points.back(), lines[2].points.front());
  EXPECT_NEAR(double{lines[1].points.front().x}, 5, 0.4);
  EXPECT_NEAR(double{lines[1].points.back().x}, 8.6, 0.4);
  EXPECT_EQ(CurbPoints().along(curve, 0, 5).along(curve, 5.12, 5.5, 0.03).along(curve, 5.62, 9).lines().size(), 1U)
      << "half a metre is no driveway";
}

TEST(CurbLines, ParallelKerbsStayApart) {
  const auto facing = CurbPoints()
                          .along(straight({0, 0}, 0), 0, 8)
                          .along(straight({8, 0.5}, std::numbers::pi), 0, 8)  // an island between
                          .lines();
  ASSERT_EQ(facing.size(), 2U);
  const auto steps = CurbPoints().along(straight({0, 0}, 0), 0, 8).along(straight({0, 0.6}, 0), 0, 8).lines();
  ASSERT_EQ(steps.size(), 2U);
  for (const auto& lines : {facing, steps}) {
    for (const tile::CurbLine& line : lines) EXPECT_NEAR(length_of(line), 8, 0.15);
  }
}

TEST(CurbLines, ACornerIsNotCut) {
  CurbPoints points;
  points.along(straight({0, 0}, 0), 0, 6).along(straight({6, 0}, std::numbers::pi / 2), 0.06, 6);
  double nearest = 1;
  for (const tile::CurbLine& line : points.lines()) {
    for (const tile::CurbVertex& v : line.points) {
      const double off_first = double{v.x} < 6.1 ? std::abs(double{v.y}) : 1;
      const double off_second = double{v.y} > -0.1 ? std::abs(double{v.x} - 6) : 1;
      EXPECT_LT(std::min(off_first, off_second), 0.04) << place(v).transpose();
      nearest = std::min(nearest, (place(v) - Eigen::Vector2d(6, 0)).norm());
    }
  }
  EXPECT_LT(nearest, 0.15);
}

TEST(CurbLines, KeepTheirIdsWhileTheyGrow) {
  CurbPoints points;
  CurbLineIds ids;
  const Curve first = straight({0, 0}, 0);
  const Curve second = straight({0, 7}, 0);
  std::vector<std::int32_t> seen;
  for (double s = 0; s < 12; s += 3) {
    points.along(second, s, s + 3 - kCell);
    auto lines = points.lines();
    ids.assign(lines);
    ASSERT_EQ(lines.size(), 1U);
    seen.push_back(lines[0].id);
  }
  EXPECT_EQ(seen, std::vector<std::int32_t>(4, seen[0]));
  CurbPoints more(3);
  more.along(first, 0, 5);
  more.points.insert(more.points.end(), points.points.begin(), points.points.end());
  auto lines = more.lines();
  ids.assign(lines);
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_NE(lines[0].id, seen[0]) << "a new curb";
  EXPECT_EQ(lines[1].id, seen[0]);
}

TEST(CurbLines, OfFewPointsAndOfManyInOnePlaceNothingBadBecomes) {
  EXPECT_TRUE(link_curbs({}).empty());
  EXPECT_TRUE(link_curbs({MapCurbPoint{}}).empty());
  EXPECT_TRUE(link_curbs(std::vector<MapCurbPoint>(200)).empty());
  const auto two = CurbPoints(1, 0).along(straight({3, 4}, 0), 0, 0.6).lines();
  ASSERT_EQ(two.size(), 1U);
  for (const tile::CurbVertex& v : two[0].points) EXPECT_NEAR(double{v.y}, 4, 1e-4);
}

}  // namespace
}  // namespace curbstone::semantic_map::curb_lines
