#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "synthetic_ground.hpp"

namespace curbstone {
namespace {

constexpr double kDensity = 250;

// --- Ground without curbs -------------------------------------------------------------------------------------------

struct Ground {
  const char* name;
  std::function<double(double, double)> height;
};

class CurblessGround : public testing::TestWithParam<Ground> {};

TEST_P(CurblessGround, GivesNoCurbAndIsAllRoad) {
  SyntheticCloud cloud;
  cloud.ground(0, 0, 15, 15, kDensity, GetParam().height);
  const CloudMap map = map_of(cloud);
  EXPECT_TRUE(map.curbs.empty()) << map.curbs.size() << " curb points";
  int road = 0;
  int seen = 0;
  for (const MapTile& tile : map.tiles) {
    for (const CellClass c : tile.cell_class) {
      seen += c != CellClass::kUnknown ? 1 : 0;
      road += c == CellClass::kRoad ? 1 : 0;
    }
  }
  EXPECT_GT(seen, 12'000);
  EXPECT_EQ(road, seen);
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, CurblessGround,
    testing::Values(Ground{"Flat", [](double, double) { return 0.0; }},
                    Ground{"Hill10Percent", [](double x, double) { return 0.10 * x; }},
                    Ground{"Crossfall", [](double x, double y) { return 0.02 * x + 0.025 * std::abs(y - 7.5); }},
                    Ground{"RampOf12PercentFromTheFlat", [](double x, double) { return 0.12 * std::max(0.0, x - 7); }},
                    Ground{"LongWave",
                           [](double x, double y) { return 0.15 * std::sin(x * 0.6) + 0.1 * std::cos(y * 0.5); }},
                    Ground{"FarBelow", [](double, double) { return -123.4; }}),
    [](const auto& test) { return std::string(test.param.name); });

// --- Curbs ----------------------------------------------------------------------------------------------------------

struct Curb {
  double height;  // m
  double yaw;     // rad, direction along the curb
  double crossfall;
};

class StraightCurb : public testing::TestWithParam<Curb> {
 protected:
  /// Road on the right of the line through (7.5, 7.5), pavement `height` higher on its left, riser in between.
  static SyntheticCloud make(const Curb& curb) {
    SyntheticCloud cloud;
    const Eigen::Vector2d along(std::cos(curb.yaw), std::sin(curb.yaw));
    const Eigen::Vector2d up(-along.y(), along.x());
    const auto height = [=](double x, double y) {
      const double u = (Eigen::Vector2d(x, y) - kCentre).dot(up);
      return curb.crossfall * u + (u > 0 ? curb.height : 0.0);
    };
    cloud.ground(0, 0, 15, 15, kDensity, height);
    const Eigen::Vector2d a = kCentre - 7.0 * along;
    const Eigen::Vector2d b = kCentre + 7.0 * along;
    cloud.face(a.x(), a.y(), b.x(), b.y(), 0, curb.height, kDensity);
    return cloud;
  }
  static inline const Eigen::Vector2d kCentre{7.5, 7.5};
};

TEST_P(StraightCurb, IsFoundAtItsFootWithItsHeightAndNowhereElse) {
  const Curb curb = GetParam();
  const CloudMap map = map_of(make(curb));
  const Eigen::Vector2d along(std::cos(curb.yaw), std::sin(curb.yaw));
  const Eigen::Vector2d up(-along.y(), along.x());
  std::vector<bool> covered(50);  // 0.2 m each, over 10 m
  double sum = 0;
  double sum2 = 0;
  double heights = 0;
  int n = 0;
  for (const CloudCurb& c : map.curbs) {
    const Eigen::Vector2d d = c.foot.head<2>() - kCentre;
    const double t = d.dot(along);
    if (std::abs(t) > 5) continue;
    covered[static_cast<std::size_t>((t + 5) * 4.999)] = true;
    const double u = d.dot(up);
    EXPECT_LT(std::abs(u), 0.12) << "a curb where there is none";
    EXPECT_GT(c.up.dot(up), 0.9);
    sum += u;
    sum2 += u * u;
    heights += c.height;
    ++n;
  }
  ASSERT_GT(n, 20);
  EXPECT_GE(std::count(covered.begin(), covered.end(), true), 45) << "of 50 pieces of 0.2 m";
  EXPECT_LT(std::abs(sum / n), 0.02) << "bias of the foot, m";
  EXPECT_LT(std::sqrt(sum2 / n), 0.035) << "rms of the foot, m";
  EXPECT_NEAR(heights / n, curb.height, 0.012);
  EXPECT_EQ(class_at(map, 7.5 - 2 * up.x(), 7.5 - 2 * up.y()), CellClass::kRoad);
  EXPECT_EQ(class_at(map, 7.5 + 2 * up.x(), 7.5 + 2 * up.y()), CellClass::kRoad) << "pavement is road";
}

INSTANTIATE_TEST_SUITE_P(Heights, StraightCurb,
                         testing::Values(Curb{0.06, 0, 0}, Curb{0.10, 0.3, 0}, Curb{0.15, 1.2, 0.02},
                                         Curb{0.06, 2.5, 0.025}, Curb{0.20, -0.7, 0}),
                         [](const auto& test) {
                           return std::to_string(std::lround(100 * test.param.height)) + "cmYaw" +
                                  std::to_string(std::lround(std::abs(10 * test.param.yaw)));
                         });

TEST(Curbs, AKerbWhoseFaceLeansBackIsReportedAtItsFootToo) {
  SyntheticCloud cloud;  // 10 cm high, 8 cm deep; range noise of 1 cm across, as beams come in flat
  cloud.ground(0, 0, 12, 6, kDensity, [](double, double) { return 0.0; });
  cloud.ground(0, 6.08, 12, 12, kDensity, [](double, double) { return 0.10; });
  for (int i = 0; i < 12 * 60; ++i) {
    const double up = cloud.uniform(0, 1);
    cloud.add(cloud.uniform(0, 12), 6 + 0.08 * up + cloud.uniform(-0.02, 0.02), 0.10 * up);
  }
  double sum = 0;
  int n = 0;
  for (const CloudCurb& c : map_of(cloud).curbs) {
    if (c.foot.x() < 1 || c.foot.x() > 11) continue;
    EXPECT_LT(std::abs(c.foot.y() - 6), 0.08);
    sum += c.foot.y() - 6;
    ++n;
  }
  ASSERT_GT(n, 60);
  EXPECT_LT(std::abs(sum / n), 0.02) << "m; the middle of the face is at 0.04";
}

TEST(Curbs, TiltAndStepAloneFindTheLineToo) {
  SyntheticCloud cloud;
  cloud.ground(0, 0, 12, 12, kDensity, [](double, double y) { return y > 6 ? 0.12 : 0.0; });
  cloud.face(0, 6, 12, 6, 0, 0.12, kDensity);
  for (const bool tilt : {true, false}) {
    CloudMapOptions options;
    options.curb.use_tilt = tilt;
    options.curb.use_step = !tilt;
    const CloudMap map = map_of(cloud, options);
    int near = 0;
    for (const CloudCurb& c : map.curbs) near += std::abs(c.foot.y() - 6) < 0.24 ? 1 : 0;
    EXPECT_GT(near, tilt ? 20 : 60) << (tilt ? "tilt" : "step");
  }
}

TEST(Curbs, BesideAParkedCarAreFound) {
  SyntheticCloud cloud;
  cloud.ground(0, 0, 12, 12, kDensity, [](double, double y) { return y > 6 ? 0.12 : 0.0; });
  cloud.face(0, 6, 12, 6, 0, 0.12, kDensity);
  cloud.box(4, 3.9, 8.2, 5.7, 0.25, 1.45, kDensity);  // 0.3 m from the curb
  const CloudMap map = map_of(cloud);
  int beside = 0;
  for (const CloudCurb& c : map.curbs) {
    EXPECT_LT(std::abs(c.foot.y() - 6), 0.12) << "at x " << c.foot.x();
    beside += c.foot.x() > 4.2 && c.foot.x() < 8.0 ? 1 : 0;
  }
  EXPECT_GT(beside, 24) << "of about 32";
  EXPECT_EQ(class_at(map, 6, 4.8), CellClass::kWall) << "the car";
}

// --- Classes --------------------------------------------------------------------------------------------------------

/// Detections along x from 0.5 m on, 8 a metre; how many of them the filter keeps.
std::size_t kept_of_line(double length, double score) {
  std::vector<CurbCandidate> candidates;
  for (double x = 0.5; x <= 0.5 + length; x += 0.125) {
    CurbCandidate c;
    c.at = {x, 1.5};
    c.up = Eigen::Vector2d::UnitY();
    c.height = 0.1;
    c.score = score;
    candidates.push_back(c);
  }
  Around<std::vector<CurbCandidate>> around;
  around.set(0, 0, &candidates);
  return filter_curbs(around, {}).size();
}

TEST(CurbFilter, AShortLineMustBeOfCertainStepsALongOneMayBeOfLessCertain) {
  EXPECT_EQ(kept_of_line(1.0, 5), 0U);
  EXPECT_GE(kept_of_line(1.0, 12), 8U);
  EXPECT_GE(kept_of_line(2.4, 6), 18U);
}

TEST(Classes, AWallIsAWallABoxAnObstacleAndACrownNeither) {
  SyntheticCloud cloud;
  cloud.ground(0, 0, 12, 12, kDensity, [](double, double) { return 0.0; });
  cloud.face(0, 10.5, 12, 10.5, 0, 3, 400);
  cloud.box(3, 3, 3.5, 3.5, 0, 0.8, 1500);
  for (int i = 0; i < 6000; ++i) cloud.add(cloud.uniform(7, 9), cloud.uniform(3, 5), cloud.uniform(2.4, 4));
  const CloudMap map = map_of(cloud);
  EXPECT_EQ(class_at(map, 6, 10.5), CellClass::kWall);
  EXPECT_EQ(class_at(map, 3.24, 3.0), CellClass::kObstacle);
  EXPECT_EQ(class_at(map, 8, 4), CellClass::kRoad) << "what hangs above the vehicle does not block";
  EXPECT_EQ(class_at(map, 6, 6), CellClass::kRoad);
  for (const CloudCurb& c : map.curbs) ADD_FAILURE() << "a curb at " << c.foot.transpose();
}

TEST(Classes, AVehicleBlocksAllOfItsOutlineThoughTheGroundBeneathItIsSeen) {
  SyntheticCloud cloud;  // body 4.2 x 1.8 m, seen from below y = 4; light gets under it, its roof is out of sight
  cloud.ground(-6, -3, 12, 12, kDensity, [](double, double) { return 0.0; });
  cloud.face(2, 4, 6.2, 4, 0.25, 0.85, 400);
  cloud.face(2, 4, 2, 5.8, 0.25, 0.85, 400);
  cloud.face(6.2, 4, 6.2, 5.8, 0.25, 0.85, 400);
  cloud.face(3, 4.1, 5.2, 4.1, 0.85, 1.45, 400);
  const CloudMap map = map_of(cloud);
  for (const double x : {2.4, 3.5, 5.0, 5.8}) {
    EXPECT_EQ(class_at(map, x, 4.5), CellClass::kWall) << x << ": beneath";
    EXPECT_EQ(class_at(map, x, 4.0), CellClass::kWall) << x << ": bonnet and doors are of the vehicle";
    EXPECT_EQ(class_at(map, x, 3.5), CellClass::kRoad) << x << ": beside";
    EXPECT_EQ(class_at(map, x, 6.3), CellClass::kRoad) << x << ": behind";
  }
}

TEST(Classes, TheCornerOfALongWallIsNoVehicle) {
  SyntheticCloud cloud;
  cloud.ground(-3, -3, 12, 12, kDensity, [](double, double) { return 0.0; });
  cloud.face(1, 1, 9, 1, 0, 1.5, 400);
  cloud.face(1, 1, 1, 9, 0, 1.5, 400);
  const CloudMap map = map_of(cloud);
  EXPECT_EQ(class_at(map, 1.5, 1.5), CellClass::kRoad) << "who is inside the corner can drive there";
  EXPECT_EQ(class_at(map, 5, 1), CellClass::kWall);
}

TEST(Classes, APointOnTheEdgeOfACellBlocksBothAndASingleOneOnlyBesideOthers) {
  const ClassParameters parameters;
  Around<CellColumns> around;
  auto columns = std::make_unique<CellColumns>();
  const auto put = [&](int column, int row, const CellColumn& cell) {
    const auto i = static_cast<std::size_t>(row * kCellsPerTile + column);
    columns->cells[i] = cell;
    columns->standing.set(i);
  };
  columns->cells.fill({.points = 5, .ground_points = 5});
  put(5, 5, {.points = 5, .ground_points = 5, .blocking_points = 4, .top = 0.5F, .at_edge = {0, 2, 0, 0}});
  put(5, 6, {.points = 5, .ground_points = 5, .blocking_points = 1});    // beside it
  put(20, 20, {.points = 5, .ground_points = 5, .blocking_points = 1});  // alone
  around.set(0, 0, columns.get());
  MapTile tile;
  classify_cells(around, {}, parameters, tile);
  const auto class_of = [&](int column, int row) {
    return tile.cell_class[static_cast<std::size_t>(row * kCellsPerTile + column)];
  };
  EXPECT_EQ(class_of(5, 5), CellClass::kObstacle);
  EXPECT_EQ(class_of(6, 5), CellClass::kObstacle);
  EXPECT_EQ(class_of(4, 5), CellClass::kRoad);
  EXPECT_EQ(class_of(5, 6), CellClass::kObstacle);
  EXPECT_EQ(class_of(20, 20), CellClass::kRoad);
}

TEST(Classes, WhatWasNotSeenIsUnknownAndTheSafePolicyDoesNotEnterIt) {
  SyntheticCloud cloud;
  cloud.ground(0, 0, 5, 9, kDensity, [](double, double) { return 0.0; });
  cloud.ground(7, 0, 9, 9, kDensity, [](double, double) { return 0.0; });
  const CloudMap map = map_of(cloud);
  EXPECT_EQ(class_at(map, 5.9, 4), CellClass::kUnknown);
  const ClassParameters safe;
  ClassParameters paper;
  paper.unknown_is_free = true;
  EXPECT_EQ(traversal_cost(CellClass::kUnknown, 0, safe), 255);
  EXPECT_EQ(traversal_cost(CellClass::kUnknown, 0, paper), 0);
  EXPECT_EQ(traversal_cost(CellClass::kRoad, 0, safe), 0);
  EXPECT_EQ(traversal_cost(CellClass::kWall, 0, safe), 254);
  EXPECT_EQ(traversal_cost(CellClass::kCurb, 0.30, safe), 254) << "higher than the vehicle may climb";
  EXPECT_LT(traversal_cost(CellClass::kCurb, 0.05, safe), traversal_cost(CellClass::kCurb, 0.14, safe));
}

// --- The map as a function of the voted tiles -----------------------------------------------------------------------

class PipelineOfAStreet : public testing::Test {
 protected:
  static const std::vector<VotedTile>& tiles() {
    static const std::vector<VotedTile> voted = [] {
      SyntheticCloud cloud;
      cloud.ground(-9, -9, 9, 9, 150, [](double x, double y) { return 0.02 * x + (y > 1 ? 0.1 : 0.0); });
      CloudMap counts;
      CloudMapOptions options;
      options.threads = 1;
      return vote_tiles(cloud.points, options, counts);
    }();
    return voted;
  }
  /// What the tiles say when all of them are there at once.
  static const TilePipeline& at_once() {
    static const TilePipeline pipeline = [] {
      TilePipeline p({}, {});
      for (const VotedTile& tile : tiles()) p.set_voted(tile);
      p.settle();
      return p;
    }();
    return pipeline;
  }
  static VotedTile thinner(VotedTile tile) {
    tile.points.resize(tile.points.size() / 2);
    return tile;
  }
  static void expect_as_at_once(const TilePipeline& pipeline) {
    for (const VotedTile& tile : tiles()) {
      EXPECT_EQ(*pipeline.classes(tile.key), *at_once().classes(tile.key)) << tile.key.x << ' ' << tile.key.y;
      EXPECT_EQ(*pipeline.curbs(tile.key), *at_once().curbs(tile.key)) << tile.key.x << ' ' << tile.key.y;
    }
    EXPECT_EQ(pipeline.num_stale(), 0U);
  }
};

TEST_F(PipelineOfAStreet, DoesNotDependOnTheOrderOfTilesNorOnWhoLooksWhen) {
  TilePipeline backward({}, {});
  for (auto it = tiles().rbegin(); it != tiles().rend(); ++it) {
    backward.set_voted(thinner(*it));
    (void)backward.update(it->key);
    for (int i = 0; i < 7; ++i) (void)backward.settle_one();
    backward.set_voted(*it);
    if (it->key.x % 2 == 0) (void)backward.update(it->key);
  }
  while (backward.settle_one()) continue;
  expect_as_at_once(backward);
}

TEST_F(PipelineOfAStreet, ComesBackFromEveryOtherRevisionOfATile) {
  TilePipeline pipeline = at_once();
  for (std::size_t i = 0; i < tiles().size(); i += 5) {
    pipeline.set_voted(thinner(tiles()[i]));
    pipeline.settle();
    pipeline.set_voted(tiles()[i]);
  }
  pipeline.settle();
  expect_as_at_once(pipeline);
}

/// While others grow beside it, so that the ground about it becomes another in between.
TEST_F(PipelineOfAStreet, WhatGrowsBitByBitComesOutAsWhatCameAtOnce) {
  TilePipeline pipeline({}, {});
  for (const unsigned parts : {7U, 3U, 2U, 1U}) {
    for (VotedTile tile : tiles()) {
      tile.points.resize(tile.points.size() / parts);
      pipeline.set_voted(tile, parts != 7U);
      (void)pipeline.update_columns(tile.key);
      if (tile.key.x % 3 == 0) (void)pipeline.update(tile.key);
    }
  }
  pipeline.settle();
  expect_as_at_once(pipeline);
}

TEST_F(PipelineOfAStreet, ShowsWhatIsNewOnTheGroundOfBeforeAndTheRestWhenItsTurnComes) {
  TilePipeline pipeline = at_once();
  VotedTile tile = tiles()[tiles().size() / 2];
  (void)pipeline.update_columns(tile.key);
  VotedTile beside = *pipeline.voted({tile.key.x + 1, tile.key.y});
  for (VotedPoint& p : beside.points) p.z += 0.15F;
  pipeline.set_voted(beside);
  (void)pipeline.update(beside.key);  // the ground between the two rises
  VotedPoint low;                     // just high enough to be in the way, on the ground of before
  low.x = 2.82F;
  low.y = 1.5F;
  const double x = tile.key.x * kTileSize + 2.82, y = tile.key.y * kTileSize + 1.5;
  low.z = static_cast<float>(0.02 * x + (y > 1 ? 0.1 : 0.0) + 0.24);
  tile.points.insert(tile.points.end(), 3, low);
  pipeline.set_voted(tile, true);
  constexpr std::size_t kCell = 12 * kCellsPerTile + 23;
  EXPECT_EQ(pipeline.update_columns(tile.key)->cell_class[kCell], CellClass::kObstacle);
  pipeline.settle();
  EXPECT_NE(pipeline.classes(tile.key)->cell_class[kCell], CellClass::kObstacle);
  TilePipeline again = at_once();
  again.set_voted(beside);
  again.set_voted(tile);
  again.settle();
  EXPECT_EQ(*pipeline.classes(tile.key), *again.classes(tile.key));
}

TEST_F(PipelineOfAStreet, DoesNothingMoreForATileThatCameOutAsItWas) {
  TilePipeline pipeline = at_once();
  (void)pipeline.take_changed();
  const VotedTile& tile = tiles()[tiles().size() / 2];
  pipeline.set_voted(tile);
  const std::int64_t before = pipeline.num_evidence();
  pipeline.settle();
  EXPECT_LE(pipeline.num_evidence() - before, 9) << "its neighbours look at its points, and nobody looks at theirs";
  EXPECT_TRUE(pipeline.take_changed().empty());
}

TEST_F(PipelineOfAStreet, UpdatesOneTileAtThePriceOfOne) {
  TilePipeline pipeline({}, {});
  for (const VotedTile& tile : tiles()) pipeline.set_voted(tile);
  const VotedTile& tile = tiles()[tiles().size() / 2];
  EXPECT_EQ(pipeline.update(tile.key)->utime, tile.utime);
  EXPECT_EQ(pipeline.num_evidence(), 1);
}

TEST(TilePipeline, HasNoJumpsAtTilesOffTheEndOfInt32) {
  TilePipeline pipeline({}, {});
  VotedTile tile;
  tile.key = {2147483647, -2147483647 - 1};
  tile.points.resize(10);
  pipeline.set_voted(tile);
  EXPECT_TRUE(pipeline.update(tile.key));
  pipeline.settle();
  EXPECT_EQ(pipeline.num_stale(), 0U);
}

}  // namespace
}  // namespace curbstone
