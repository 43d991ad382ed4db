#include "tools/evaluate/curb_score.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace curbstone::evaluate {
namespace {

/// A straight curb at y = 3 from x = 0 to 10, seen from a path along y = 0.
std::vector<truth::TrueCurbPoint> curb_at(double y, bool dropped = false, int line = 0) {
  std::vector<truth::TrueCurbPoint> points;
  for (int i = 0; i <= 100; ++i) points.push_back({line, 0.1 * i, y, 0, 0.1, dropped});
  return points;
}
std::vector<Place> row(double y) {
  std::vector<Place> places;
  for (int i = 0; i <= 83; ++i) places.push_back({0.12 * i, y});
  return places;
}

std::vector<CurbCell> cells_at(const std::vector<Place>& places, bool judged = true) {
  std::vector<CurbCell> cells;
  for (const Place& place : places) cells.push_back({place, judged});
  return cells;
}

/// A mapped curb line along y with its higher side to the left (+y).
std::vector<CurbFoot> line(double y) {
  std::vector<CurbFoot> feet;
  for (const Place& place : row(y)) feet.push_back({place, {0, 1}});
  return feet;
}

TEST(CurbScore, PerfectMapScoresOne) {
  const auto score = score_curbs({cells_at(row(3)), line(3), row(3)}, curb_at(3), row(0), 8);
  for (const Score& s : score.at) EXPECT_EQ(s.f1(), 1.0);
  EXPECT_EQ(score.lateral_median_cm, 0.0);
}

TEST(CurbScore, LoweredKerbsAreFoundByTheLinesThatAreMarkedSo) {
  auto truth = curb_at(3);
  const auto lowered = curb_at(-3, true, 1);
  truth.insert(truth.end(), lowered.begin(), lowered.end());
  CurbMap map{cells_at(row(3)), line(3), row(3)};
  EXPECT_EQ(score_curbs(map, truth, row(0), 8).lowered_points, 101);
  EXPECT_EQ(score_curbs(map, truth, row(0), 8).lowered_found, 0);
  map.lowered = row(-3.1);
  map.lowered.push_back({5, 3});  // a curb that is not lowered
  const auto score = score_curbs(map, truth, row(0), 8);
  EXPECT_EQ(score.lowered_found, 101);
  EXPECT_EQ(score.lowered_feet, 85);
  EXPECT_EQ(score.lowered_wrong, 1);
}

TEST(CurbScore, AnOffsetFailsTheToleranceItExceeds) {
  const auto score = score_curbs({cells_at(row(3.2)), line(3.2), row(3.2)}, curb_at(3), row(0), 8);
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
  const auto score = score_curbs({cells_at(cells), {}, cells}, curb_at(3), row(0), 8);
  EXPECT_NEAR(score.at[2].precision, 0.5, 1e-9);
  EXPECT_NEAR(score.at[2].recall, 0.5, 0.05);
  EXPECT_NEAR(score.recall_of_seen, 1.0, 1e-9);
  EXPECT_EQ(score.wrong.size(), ghosts.size());
  ASSERT_EQ(score.missed.size(), static_cast<std::size_t>(std::lround(score.true_points * (1 - score.at[2].recall))));
  EXPECT_EQ(score.missed.front().y, 3);
}

TEST(CurbScore, LoweredKerbsDoNotCount) {
  auto truth = curb_at(3);
  const auto dropped = curb_at(-3, true, 1);
  truth.insert(truth.end(), dropped.begin(), dropped.end());
  auto cells = row(3);
  const auto on_dropped = row(-3);
  cells.insert(cells.end(), on_dropped.begin(), on_dropped.end());
  const auto score = score_curbs({cells_at(cells), {}, cells}, truth, row(0), 8);
  EXPECT_EQ(score.at[0].f1(), 1.0);
  EXPECT_EQ(score.on_dropped, 84);
}

TEST(CurbScore, InferredCurbsHaveARowOfTheirOwn) {
  const auto truth = curb_at(3);
  const auto cells = row(3);
  const std::vector<Place> seen(cells.begin(), cells.begin() + 40);
  CurbMap map{cells_at(seen), {}, seen};
  const double before = score_curbs(map, truth, row(0), 8).at[2].recall;
  for (double x = 5; x < 9.95; x += 0.1) map.inferred.push_back({{x, 3.1}, 0.1});
  for (double x = 5; x < 9.95; x += 0.1) map.inferred.push_back({{x, -3}, 0.1});
  for (double x = 5; x < 9.95; x += 0.1) map.inferred.push_back({{x, -4}, 0.1, false});  // where the truth is blind
  const auto score = score_curbs(map, truth, row(0), 8);
  EXPECT_EQ(score.at[2].recall, before);
  EXPECT_EQ(score.at[2].precision, 1.0);
  EXPECT_NEAR(score.inferred_m, 10.0, 1e-6);
  EXPECT_NEAR(score.inferred_right, 0.5, 1e-6);
  EXPECT_GT(score.inferred_found, 40);
  EXPECT_LE(score.inferred_found, static_cast<int>(score.missed.size()));
}

TEST(CurbScore, TellsTheLateralBiasFromItsSpread) {
  CurbMap map{cells_at(row(3)), {}, row(3)};
  for (const double y : {2.93, 2.95, 2.97}) {
    const auto feet = line(y);
    map.feet.insert(map.feet.end(), feet.begin(), feet.end());
  }
  const auto score = score_curbs(map, curb_at(3), row(0), 8);
  EXPECT_NEAR(score.lateral_bias_cm, -5.0, 1e-6);  // on the lower side of the true foot
  EXPECT_NEAR(score.lateral_spread_cm, 1.4826 * 2.0, 1e-6);
  EXPECT_NEAR(score.lateral_median_cm, 5.0, 1e-6);
  EXPECT_NEAR(score.lateral_p95_cm, 7.0, 1e-6);
}

TEST(CurbScore, GivesRecallByTheHeightOfTheStep) {
  auto truth = curb_at(3);  // 0.10 m
  for (truth::TrueCurbPoint point : curb_at(-3, false, 1)) {
    point.height = 0.05;
    truth.push_back(point);
  }
  const auto score = score_curbs({cells_at(row(3)), {}, row(3)}, truth, row(0), 8);
  EXPECT_EQ(score.by_step[0].points, 101);
  EXPECT_EQ(score.by_step[0].found, 0);
  EXPECT_EQ(score.by_step[2].points, 101);
  EXPECT_EQ(score.by_step[2].found, 101);
  EXPECT_NEAR(score.at[2].recall, 0.5, 1e-9);
}

TEST(CurbScore, AGhostWhereTheTruthKnowsNothingIsNotWrong) {
  CurbMap map{cells_at(row(3)), {}, row(3)};
  const auto ghosts = cells_at(row(5), false);
  map.cells.insert(map.cells.end(), ghosts.begin(), ghosts.end());
  const auto score = score_curbs(map, curb_at(3), row(0), 8);
  EXPECT_EQ(score.at[0].precision, 1.0);
  EXPECT_EQ(score.beyond_truth, 84);
}

TEST(CurbScore, OnlyNearThePath) {
  const auto score = score_curbs({cells_at(row(3)), {}, {}}, curb_at(30), row(0), 8);
  EXPECT_EQ(score.true_points, 0);
  EXPECT_EQ(score.detections, 84);
  EXPECT_EQ(score.at[2].f1(), 0.0);
}

TEST(CurbScore, NothingAgainstNothingIsZeroNotNan) {
  const auto score = score_curbs({}, {}, {}, 8);
  EXPECT_EQ(score.at[0].f1(), 0.0);
}

}  // namespace
}  // namespace curbstone::evaluate
