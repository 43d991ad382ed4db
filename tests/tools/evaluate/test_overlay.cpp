#include "tools/evaluate/overlay.hpp"

#include <gtest/gtest.h>

namespace curbstone::evaluate {
namespace {

TEST(TruthLines, AreTheCurbsAndThePathInMap) {
  truth::Truth truth;
  truth.curbs = {{0, 10, 5, 0, 0.1, false},
                 {0, 10.1, 5, 0, 0.1, false},
                 {0, 10.2, 5, 0, 0.02, true},
                 {1, 10.3, 5, 0, 0.1, false},
                 {1, 12.0, 5, 0, 0.1, false}};
  truth.poses = {{0, Pose::Identity()}};
  Pose T_truth_map = Pose::Identity();
  T_truth_map.translation() = Eigen::Vector3d(10, 5, 0);
  const auto lines = truth_lines(truth, T_truth_map);
  ASSERT_EQ(lines.size(), 5U);  // a curb, another, the same beyond a gap; a lowered one; the path
  ASSERT_EQ(lines[0].points.size(), 3U);
  EXPECT_NEAR(lines[0].points[2].x(), 0.1, 1e-12);
  EXPECT_NEAR(lines[0].points[2].y(), 0.0, 1e-12);
  EXPECT_EQ(lines[3].points.size(), 2U) << "a dot";
  EXPECT_EQ(lines[0].colour, lines[2].colour);
  EXPECT_NE(lines[0].colour, lines[3].colour);
  EXPECT_NEAR(lines[4].points[0].x(), -10, 1e-12);
}

TEST(ErrorDots, AreInMapAColourForEachKind) {
  Evaluation evaluation;
  evaluation.T_truth_map.translation() = Eigen::Vector3d(10, 5, 0);
  evaluation.blocking.emplace();
  evaluation.blocking->count(semantic_map::tile::CellClass::kWall, {1, 1});
  evaluation.blocking->count(semantic_map::tile::CellClass::kCurb, {12, 6});
  evaluation.blocking->called_blocked = {{13, 7}};
  evaluation.curbs.emplace();
  evaluation.curbs->missed = {{10, 5}};
  evaluation.curbs->wrong = {{11, 5}};
  const auto dots = error_dots(evaluation);
  ASSERT_EQ(dots.size(), 4U);
  EXPECT_NEAR(dots[0].points[0].x(), 3, 1e-12) << "below the others: there are many of them";
  EXPECT_NEAR(dots[1].points[0].norm(), 0, 1e-12);
  EXPECT_NEAR(dots[3].points[0].x(), 2, 1e-12);
  EXPECT_NEAR(dots[3].points[0].y(), 1, 1e-12);
  for (std::size_t a = 0; a < dots.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) EXPECT_NE(dots[a].colour, dots[b].colour);
  }
}

}  // namespace
}  // namespace curbstone::evaluate
