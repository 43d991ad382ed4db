#include "tools/evaluate/curb_score.hpp"

#include <gtest/gtest.h>

namespace curbstone {
namespace {

/// A straight curb at y = 3 from x = 0 to 10, seen from a path along y = 0.
std::vector<TrueCurbPoint> curb_at(double y, bool dropped = false, int line = 0) {
  std::vector<TrueCurbPoint> points;
  for (int i = 0; i <= 100; ++i) points.push_back({line, 0.1 * i, y, 0, 0.1, dropped});
  return points;
}
std::vector<Place> row(double y) {
  std::vector<Place> places;
  for (int i = 0; i <= 83; ++i) places.push_back({0.12 * i, y});
  return places;
}

TEST(CurbScore, PerfectMapScoresOne) {
  const auto score = score_curbs({row(3), row(3), row(3)}, curb_at(3), row(0), 8);
  for (const Score& s : score.at) EXPECT_EQ(s.f1(), 1.0);
  EXPECT_EQ(score.lateral_median_cm, 0.0);
}

TEST(CurbScore, AnOffsetFailsTheToleranceItExceeds) {
  const auto score = score_curbs({row(3.2), row(3.2), row(3.2)}, curb_at(3), row(0), 8);
  EXPECT_EQ(score.at[0].f1(), 0.0);
  EXPECT_EQ(score.at[1].f1(), 0.0);
  EXPECT_EQ(score.at[2].precision, 1.0);
  EXPECT_GT(score.at[2].recall, 0.98);
  EXPECT_NEAR(score.lateral_median_cm, 20, 1e-6);
}

TEST(CurbScore, GhostsCostPrecisionAndGapsRecall) {
  auto cells = row(3);
  cells.resize(cells.size() / 2);
  auto ghosts = row(1);
  ghosts.resize(cells.size());
  cells.insert(cells.end(), ghosts.begin(), ghosts.end());
  const auto score = score_curbs({cells, {}, cells}, curb_at(3), row(0), 8);
  EXPECT_NEAR(score.at[2].precision, 0.5, 1e-9);
  EXPECT_NEAR(score.at[2].recall, 0.5, 0.05);
  EXPECT_NEAR(score.recall_of_seen, 1.0, 1e-9);
}

TEST(CurbScore, LoweredKerbsDoNotCount) {
  auto truth = curb_at(3);
  const auto dropped = curb_at(-3, true, 1);
  truth.insert(truth.end(), dropped.begin(), dropped.end());
  auto cells = row(3);
  const auto on_dropped = row(-3);
  cells.insert(cells.end(), on_dropped.begin(), on_dropped.end());
  const auto score = score_curbs({cells, {}, cells}, truth, row(0), 8);
  EXPECT_EQ(score.at[0].f1(), 1.0);
  EXPECT_EQ(score.on_dropped, 84);
}

TEST(CurbScore, OnlyNearThePath) {
  const auto score = score_curbs({row(3), {}, {}}, curb_at(30), row(0), 8);
  EXPECT_EQ(score.true_points, 0);
  EXPECT_EQ(score.detections, 84);
  EXPECT_EQ(score.at[2].f1(), 0.0);
}

TEST(CurbScore, NothingAgainstNothingIsZeroNotNan) {
  const auto score = score_curbs({}, {}, {}, 8);
  EXPECT_EQ(score.at[0].f1(), 0.0);
}

}  // namespace
}  // namespace curbstone
