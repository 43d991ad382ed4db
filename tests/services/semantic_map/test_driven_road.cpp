#include <gtest/gtest.h>

#include <curbstone/map_trajectory_t.hpp>
#include <curbstone/semantic_tile_t.hpp>
#include <functional>
#include <map>

#include "common/bus/local_bus.hpp"
#include "common/tile_sync/drive_pages.hpp"
#include "services/semantic_map/pipeline/tile_pipeline.hpp"
#include "tests/services/semantic_map/semantic_map_node_test.hpp"

namespace curbstone::semantic_map {
namespace {

/// Ground around a place of 3 x 3 m that no beam has hit, about the origin.
class DrivenRoadNode : public SemanticMapNodeTest {
 protected:
  static const std::vector<tile::VotedTile>& tiles() {
    static const std::vector<tile::VotedTile> voted = [] {
      SyntheticCloud cloud;
      const auto level = [](double, double) { return 0.2; };
      cloud.ground(-6, -6, 6, -1.5, 250, level);
      cloud.ground(-6, 1.5, 6, 6, 250, level);
      cloud.ground(-6, -1.5, -1.5, 1.5, 250, level);
      cloud.ground(1.5, -1.5, 6, 1.5, 250, level);
      detect::cloud_map::CloudMapOptions options;
      options.threads = 1;
      detect::cloud_map::CloudMap counts;
      return detect::cloud_map::vote_tiles(cloud.points, options, counts);
    }();
    return voted;
  }
  static std::map<TileKey, cells::CellBits> beneath() {
    return cells::cells_beneath(Pose::Identity(), VehicleConfig{});
  }
  static int num_beneath() {
    int count = 0;
    for (const auto& [key, cells] : beneath()) count += static_cast<int>(cells.count());
    return count;
  }
  /// The cells of the unseen place that are road.
  static int road_in_the_hole(const std::function<tile::MapTile(TileKey)>& tile_at) {
    int road = 0;
    for (const auto& [key, cells] : beneath()) {
      const tile::MapTile tile = tile_at(key);
      for (std::size_t i = 0; i < tile::kCellsInTile; ++i) {
        if (!cells[i] || tile.cell_class[i] != tile::CellClass::kRoad) continue;
        ++road;
        EXPECT_NEAR(double{tile.z_origin} + tile.height[i] * kPositionStep, 0.2, 0.03);
      }
    }
    return road;
  }
  static int road_in(const pipeline::TilePipeline& pipeline) {
    return road_in_the_hole([&](TileKey key) { return *pipeline.classes(key); });
  }
  /// Of the tiles that a node with these messages has published.
  template <class Message>
  int road_after(const char* channel, const Message& message) {
    LocalBus bus;
    SemanticMapNode node(config(""), bus);
    node.connect(bus);
    std::map<TileKey, tile::MapTile> newest;
    bus.subscribe<semantic_tile_t>("SEMANTIC_TILE", [&](const semantic_tile_t& m) {
      tile::MapTile& tile = newest[{m.tile_x, m.tile_y}];
      tile.z_origin = m.z_origin;
      for (std::size_t i = 0; i < tile::kCellsInTile; ++i) {
        tile.cell_class[i] = static_cast<tile::CellClass>(m.cell_class[i]);
        tile.height[i] = m.height[i];
      }
    });
    bus.publish("MAP_POSE", pose_at(kStart, -30));
    bus.publish(channel, message);
    for (const tile::VotedTile& tile : tiles()) {
      for (const voted_points_t& page : to_pages(tile, 2, 400)) bus.publish("VOTED_POINTS", page);
    }
    bus.dispatch();
    node.finish();
    bus.dispatch();
    return road_in_the_hole([&](TileKey key) { return newest.at(key); });
  }
};

TEST_F(DrivenRoadNode, IsTheSameHoweverEarlyItWasDriven) {
  pipeline::TilePipeline none({}, {}), before({}, {}), after({}, {});
  for (const auto& [key, cells] : beneath()) before.add_driven(key, cells);
  for (pipeline::TilePipeline* p : {&none, &before, &after}) {
    for (const tile::VotedTile& tile : tiles()) p->set_voted(tile);
    p->settle();
  }
  for (const auto& [key, cells] : beneath()) after.add_driven(key, cells);
  EXPECT_EQ(road_in(after), 0) << "not computed yet";
  after.settle();
  EXPECT_EQ(road_in(none), 0);
  EXPECT_EQ(road_in(before), num_beneath());
  for (const TileKey key : none.keys()) EXPECT_EQ(*before.classes(key), *after.classes(key));
  EXPECT_EQ(after.num_stale(), 0U);
}

TEST_F(DrivenRoadNode, IsForgottenWithTheMap) {
  pipeline::TilePipeline pipeline({}, {});
  for (const auto& [key, cells] : beneath()) pipeline.add_driven(key, cells);
  pipeline.clear();
  for (const tile::VotedTile& tile : tiles()) pipeline.set_voted(tile);
  pipeline.settle();
  EXPECT_EQ(road_in(pipeline), 0);
}

TEST_F(DrivenRoadNode, IsWhereThePosesOfTheDriveAre) {
  EXPECT_EQ(road_after("MAP_POSE", pose_at(kStart + 1'000'000, 0)), num_beneath());
  map_pose_t guess = pose_at(kStart + 1'000'000, 0);
  guess.flags = map_pose_t::LOST;
  EXPECT_EQ(road_after("MAP_POSE", guess), 0) << "a guess is not part of the drive";
}

TEST_F(DrivenRoadNode, IsWherePosesAreThatWereLostOnTheBus) {
  map_trajectory_t page{};
  page.epoch = 1;
  page.num_poses = 1;
  page.utimes = {kStart + 1'000'000};
  page.revolutions = {20};
  page.positions = {{0, 0, 0}};
  page.orientations = {{1, 0, 0, 0}};
  for (const int kind : {kPageAgain, 0}) {
    page.page = kind;
    EXPECT_EQ(road_after("MAP_TRAJECTORY", page), num_beneath()) << kind;
  }
}

}  // namespace
}  // namespace curbstone::semantic_map
