#include "services/semantic_map/marking_lines/ball_vote.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace curbstone::semantic_map::marking_lines {
namespace {

MapMarkingCell paint_at(double x, double y, float contrast = 90) {
  MapMarkingCell cell;
  cell.at = {x, y};
  cell.contrast = contrast;
  cell.is_strong = true;
  return cell;
}

/// Two voters, whose sum is written out: w (I - r r^T) of each (docs/method.md, sections 9 and 14).
TEST(BallVoteInPlane, IsThePapersInTwoDimensions) {
  constexpr double kSigma = 0.5;
  const std::vector<MapMarkingCell> cells = {paint_at(1, 1), paint_at(1.3, 1, 30), paint_at(1, 1.4)};
  const PlaneVote vote = vote_in_plane(MarkingField(cells), 0, kSigma);
  const double along_x = 0.5 * std::exp(-0.09 / 0.25);  // worn paint counts half: 30 of 60
  const double along_y = std::exp(-0.16 / 0.25);
  EXPECT_NEAR(vote.mass, along_x + along_y, 1e-12);
  const double l1 = std::max(along_x, along_y), l2 = std::min(along_x, along_y);
  EXPECT_NEAR(vote.stick, (l1 - l2) / l1, 1e-12);
  EXPECT_NEAR(std::abs(vote.tangent.y()), 1, 1e-12) << "towards the voter that counts more";
}

TEST(BallVoteInPlane, ReachesTwoAndAHalfSigma) {
  for (const double away : {1.2, 1.3}) {
    const std::vector<MapMarkingCell> cells = {paint_at(0, 0), paint_at(away, 0)};
    EXPECT_EQ(vote_in_plane(MarkingField(cells), 0, 0.5).mass > 0, away < 1.25) << away;
  }
}

TEST(BallVoteInPlane, CellsThatAreNotStrongDoNotVote) {
  std::vector<MapMarkingCell> cells = {paint_at(0, 0), paint_at(0.3, 0), paint_at(0.6, 0)};
  cells[1].is_strong = false;
  EXPECT_NEAR(vote_in_plane(MarkingField(cells), 0, 0.5).mass, std::exp(-0.36 / 0.25), 1e-12);
}

}  // namespace
}  // namespace curbstone::semantic_map::marking_lines
