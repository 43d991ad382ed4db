#include "tools/evaluate/evaluation.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tools/evaluate/report.hpp"

namespace curbstone::evaluate {
namespace {

/// The map is the truth turned by 90 degrees and moved: evaluation has to undo that.
struct Scene {
  Pose T_truth_map = Pose::Identity();
  truth::Trajectory trajectory;
  truth::Truth truth;
  std::vector<semantic_map::tile::MapTile> tiles;

  Scene() {
    T_truth_map.linear() = rotation_from_rpy(0, 0, 1.5707963267948966);
    T_truth_map.translation() = Eigen::Vector3d(30, 15, 0);
    for (int i = 0; i < 200; ++i) {
      Pose p = Pose::Identity();
      p.translation().x() = 0.1 * i;
      trajectory.push_back({1'000'000 + 50'000 * i, p});
      truth.poses.push_back({1'000'000 + 50'000 * i, T_truth_map * p});
    }
    semantic_map::tile::MapTile tile;  // x 0..3, y 0..3: road, with a curb along its row 12
    tile.cell_class.fill(semantic_map::tile::CellClass::kRoad);
    tile.height.fill(0);
    for (int c = 0; c < kCellsPerTile; ++c)
      tile.cell_class[static_cast<std::size_t>(12 * kCellsPerTile + c)] = semantic_map::tile::CellClass::kCurb;
    tiles.push_back(tile);
    for (int i = 0; i <= 60; ++i) {
      const Eigen::Vector3d p = T_truth_map * Eigen::Vector3d(0.05 * i, 12.5 * kCellSize, 0);
      truth.curbs.push_back({0, p.x(), p.y(), 0, 0.1, false});
    }
    truth.classes.width = truth.classes.height = 500;
    truth.classes.pixels.assign(500 * 500, 1);
  }
};

TEST(Evaluation, LaysTheMapOnTheTruthByTheTrajectories) {
  const Scene scene;
  const Evaluation e = evaluate(scene.tiles, {}, scene.trajectory, scene.truth, 8);
  EXPECT_TRUE(e.T_truth_map.isApprox(scene.T_truth_map, 1e-9));
  ASSERT_TRUE(e.curbs);
  EXPECT_EQ(e.curbs->at[0].precision, 1.0);
  EXPECT_EQ(e.curbs->at[0].recall, 1.0);
  ASSERT_TRUE(e.classes);
  EXPECT_EQ(e.classes->count[1][1], 600);
  EXPECT_EQ(e.classes->count[1][2], 25);
  EXPECT_NEAR(e.classes->accuracy(), 600.0 / 625.0, 1e-12);
}

TEST(Evaluation, ACurbInInterpolatedRoadCouldNotBeSeen) {
  Scene scene;
  semantic_map::tile::MapTile& tile = scene.tiles.front();
  tile.cell_class.fill(semantic_map::tile::CellClass::kRoad);  // the map lacks the curb
  tile.confidence.fill(0);
  for (int row = 0; row < kCellsPerTile; ++row) {
    for (int column = 0; column < 5; ++column)
      tile.confidence[static_cast<std::size_t>(row * kCellsPerTile + column)] = 32;
  }
  tile.cell_class[12 * kCellsPerTile] = semantic_map::tile::CellClass::kCurb;  // but for its first cell
  const Evaluation e = evaluate(scene.tiles, {}, scene.trajectory, scene.truth, 8);
  ASSERT_TRUE(e.curbs);
  EXPECT_NEAR(e.curbs->recall_of_seen, 0.4, 0.15) << "of the five cells in which ground was seen";
  EXPECT_LT(e.curbs->at.back().recall, 0.2);
  EXPECT_EQ(e.classes->total(), 625) << "but all that the map calls road is scored";
}

TEST(Evaluation, TellsWhatBlocksAndIsCalledFreeFromWhatIsNotKnown) {
  Scene scene;
  semantic_map::tile::MapTile& tile = scene.tiles.front();  // its first row is truly a wall
  for (int c = 0; c < kCellsPerTile; ++c) {
    const Eigen::Vector3d p = scene.T_truth_map * Eigen::Vector3d((c + 0.5) * kCellSize, 0.5 * kCellSize, 0);
    scene.truth.classes.set(p.x(), p.y(), 4);
  }
  for (std::size_t c = 0; c < 20; ++c)
    tile.cell_class[c] = c < 10 ? semantic_map::tile::CellClass::kWall : semantic_map::tile::CellClass::kObstacle;
  tile.cell_class[20] = tile.cell_class[21] = semantic_map::tile::CellClass::kUnknown;
  tile.height[21] = semantic_map::tile::MapTile::kNoHeight;  // no point fell into it
  const Evaluation e = evaluate(scene.tiles, {}, scene.trajectory, scene.truth, 8);
  ASSERT_TRUE(e.blocking);
  EXPECT_EQ(e.blocking->blocked, 20);
  ASSERT_EQ(e.blocking->free(), 3);
  const Eigen::Vector3d first = scene.T_truth_map * Eigen::Vector3d(22.5 * kCellSize, 0.5 * kCellSize, 0);
  EXPECT_NEAR(e.blocking->called_free.front().x, first.x(), 1e-6);
  EXPECT_NEAR(e.blocking->called_free.front().y, first.y(), 1e-6);
  EXPECT_EQ(e.blocking->unknown, 1);
  EXPECT_NEAR(e.blocking->recall(), 20.0 / 23.0, 1e-12);
  EXPECT_EQ(e.classes->total(), 623) << "unknown cells are not of the confusion matrix";
}

TEST(Evaluation, JudgesTheMapsOwnCellsWhereTheTruthIsFine) {
  Scene scene;
  truth::TrueClasses& fine = scene.truth.fine_classes;
  fine.resolution = 0.03;
  fine.width = fine.height = 2000;
  fine.pixels.assign(2000 * 2000, 1);
  // A wall over the last centimetres of the map's first row: no centre of a cell lies in it.
  for (double x = 0; x < 3; x += 0.01) {
    for (const double y : {0.09, 0.105}) {
      const Eigen::Vector3d p = scene.T_truth_map * Eigen::Vector3d(x, y, 0);
      fine.set(p.x(), p.y(), 4);
    }
  }
  for (std::size_t c = 0; c < 25; ++c) scene.tiles.front().cell_class[c] = semantic_map::tile::CellClass::kWall;
  const Evaluation e = evaluate(scene.tiles, {}, scene.trajectory, scene.truth, 8);
  ASSERT_TRUE(e.classes && e.firm_classes);
  EXPECT_EQ(e.classes->count[4][4], 25);
  EXPECT_EQ(e.classes->count[1][4], 0) << "by the class at its centre each of them would be a road cell called wall";
  EXPECT_EQ(e.blocking->blocked, 25);
  EXPECT_LE(e.firm_classes->total(), e.classes->total());
}

TEST(Evaluation, RefusesAnotherDrivesTruth) {
  Scene scene;
  for (auto& pose : scene.trajectory) pose.utime += 1'000'000'000;
  EXPECT_THROW((void)evaluate(scene.tiles, {}, scene.trajectory, scene.truth, 8), std::runtime_error);
}

TEST(Evaluation, JsonHasTheAgreedKeysAndNullForTheUnknown) {
  Scene scene;
  const auto json = nlohmann::json::parse(to_json(evaluate(scene.tiles, {}, scene.trajectory, scene.truth, 8)));
  for (const char* tolerance : {"0.12", "0.15", "0.24"}) {
    for (const char* key : {"precision", "recall", "f1"})
      EXPECT_TRUE(json.at("curb").at(tolerance).at(key).is_number());
  }
  for (const char* key : {"true_points", "found", "marked_points", "wrong"})
    EXPECT_TRUE(json.at("lowered_kerbs").at(key).is_number()) << key;
  EXPECT_TRUE(json.at("lateral_cm").at("median").is_number());
  EXPECT_EQ(json.at("classes").at("confusion").size(), 5U);
  EXPECT_TRUE(json.at("trajectory").at("ate_m").is_number());
  EXPECT_TRUE(json.at("dropped").is_null());
  scene.truth.curbs.clear();
  EXPECT_TRUE(
      nlohmann::json::parse(to_json(evaluate(scene.tiles, {}, scene.trajectory, scene.truth, 8))).at("curb").is_null());
}

}  // namespace
}  // namespace curbstone::evaluate
