#include "services/semantic_map/tile/voted_points.hpp"

#include <gtest/gtest.h>

namespace curbstone::semantic_map::tile {
namespace {

VotedPoint point_at(float x, float mass) {
  VotedPoint p;
  p.x = x;
  p.mass = mass;
  return p;
}

TEST(VotedPoints, PointsThatShareATensorChangeTogether) {
  VotedPoints points;
  points.push_back(point_at(0, 5));
  points.push_back(point_at(1, 7));
  points.append(VotedPoints::Place{2, 0, 0, points.places()[0].tensor});
  ASSERT_EQ(points.size(), 3U);
  EXPECT_EQ(points.tensors().size(), 2U);
  EXPECT_EQ(points[2].x, 2);
  EXPECT_EQ(points[2].mass, 5);

  VotedTensor more;
  more.mass = 50;
  points.set_tensor(points.places()[2].tensor, more);
  EXPECT_EQ(points[0].mass, 50);
  EXPECT_EQ(points[1].mass, 7);
  EXPECT_EQ(points[2].mass, 50);
}

TEST(VotedPoints, AreVisitedInTheirOrder) {
  VotedPoints points;
  for (int i = 0; i < 5; ++i) points.push_back(point_at(static_cast<float>(i), 1));
  points.shorten(3);
  float next = 0;
  for (const VotedPoint& p : points) EXPECT_EQ(p.x, next++);
  EXPECT_EQ(next, 3);
  EXPECT_TRUE(VotedPoints().empty());
}

}  // namespace
}  // namespace curbstone::semantic_map::tile
