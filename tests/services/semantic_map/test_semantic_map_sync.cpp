#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <thread>

#include "common/bus/local_bus.hpp"
#include "tests/damaged_spill_files.hpp"
#include "tests/services/semantic_map/semantic_map_node_test.hpp"

namespace curbstone::semantic_map {
namespace {

TEST_F(SemanticMapNodeTest, AsksForWhatItMissedAndAnswersWhoMissedSomething) {
  LocalBus bus;
  SemanticMapNode node(config(""), bus);
  node.connect(bus);
  std::vector<tile_request_t> requests;
  int sent = 0;
  bus.subscribe<tile_request_t>("TILE_REQUEST", [&](const tile_request_t& m) {
    if (m.requester == "semantic_map") requests.push_back(m);
  });
  bus.subscribe<semantic_tile_t>("SEMANTIC_TILE", [&](const semantic_tile_t&) { ++sent; });
  const tile::VotedTile& tile = full_tile();
  tile_index_t index{};
  index.utime = kStart;
  index.owner = "tensor_voting:1";
  index.channel = "VOTED_POINTS";
  index.epoch = 1;
  index.num_pages = 1;
  index.num_tiles = 1;
  index.tile_x = {tile.key.x};
  index.tile_y = {tile.key.y};
  index.version = {2};
  bus.publish("TILE_INDEX", index);
  bus.dispatch();
  node.tick(kStart + 1'000'000);
  bus.dispatch();
  ASSERT_EQ(requests.size(), 1U);
  EXPECT_EQ(requests[0].tile_x[0], tile.key.x);
  EXPECT_EQ(requests[0].have[0], 0);

  for (const auto& page : to_pages(tile, 2, 400)) bus.publish("VOTED_POINTS", page);
  bus.dispatch();
  node.tick(kStart + 2'500'000);
  bus.dispatch();
  EXPECT_EQ(requests.size(), 1U) << "it has what it asked for";
  EXPECT_EQ(sent, 2) << "with its points, and when its curbs know of them";

  tile_request_t request{};
  request.requester = "web";
  request.channel = "SEMANTIC_TILE";
  request.epoch = 1;
  request.num_tiles = 1;
  request.tile_x = {tile.key.x};
  request.tile_y = {tile.key.y};
  request.have = {0};
  bus.publish("TILE_REQUEST", request);
  bus.dispatch();
  node.tick(kStart + 2'520'000);
  bus.dispatch();
  EXPECT_EQ(sent, 3);
}

/// The step from the first points of a tile to all of them.
voted_points_t step_from(std::int32_t base, const voted_points_t& all, std::size_t had) {
  voted_points_t m = all;
  const auto cut = [&](auto& values) {
    values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(had));
  };
  cut(m.x), cut(m.y), cut(m.z), cut(m.intensity), cut(m.voter);
  m.first = static_cast<std::int32_t>(had);
  m.num_points = m.num_voters = static_cast<std::int32_t>(m.x.size());
  m.base = base;
  m.revision = base + 1;
  return m;
}

TEST_F(SemanticMapNodeTest, FollowsATileInStepsAndAsksWhenOneIsMissing) {
  const voted_points_t all = to_pages(full_tile(), 3, 100'000).front();
  tile::VotedTile half = full_tile();
  half.points.shorten(half.points.size() / 2);
  const voted_points_t first = to_pages(half, 2, 100'000).front();
  const voted_points_t step = step_from(2, all, half.points.size());
  const auto map_of = [&](const std::string& name, const std::vector<voted_points_t>& messages, int asked) {
    LocalBus bus;
    SemanticMapNode node(config(name), bus);
    node.connect(bus);
    int requests = 0;
    bus.subscribe<tile_request_t>("TILE_REQUEST", [&](const tile_request_t& m) { requests += m.num_tiles; });
    bus.publish("MAP_POSE", pose_at(kStart, 0));
    std::int64_t now = kStart;
    for (const voted_points_t& m : messages) {
      bus.publish("VOTED_POINTS", m);
      bus.dispatch();
      node.caught_up(now);
      node.tick(now += 200'000);
      bus.dispatch();
    }
    node.finish();
    EXPECT_EQ(requests, asked) << name;
    EXPECT_EQ(node.report().counters["dropped.gap"], asked) << name;
    return store::MapReader(config(name).map).tiles();
  };
  const auto whole = map_of("whole.db", {all}, 0);
  EXPECT_EQ(map_of("steps.db", {first, step}, 0), whole);
  EXPECT_EQ(map_of("twice.db", {first, step, first, step}, 0), whole);
  EXPECT_EQ(map_of("missed.db", {step, all}, 1), whole) << "it has nothing that the step goes on from";
  voted_points_t strange = step;
  strange.chain = 8;
  EXPECT_EQ(map_of("strange.db", {first, strange, all}, 1), whole) << "another worker's";
  voted_points_t later = step;
  later.base = 3;
  later.revision = 4;
  voted_points_t answer = all;
  answer.revision = 4;
  EXPECT_EQ(map_of("skipped.db", {first, later, answer}, 1), whole);
}

TEST_F(SemanticMapNodeTest, AsksForAFarTileThatTheDiskHasLost) {
  const voted_points_t all = to_pages(full_tile(), 3, 100'000).front();
  tile::VotedTile half = full_tile();
  half.points.shorten(half.points.size() / 2);
  tile::VotedTile elsewhere = full_tile();
  elsewhere.key = {500, 500};
  elsewhere.points.shorten(1);
  SemanticMapConfig with_room = config("lost.db");
  with_room.keep_free = 0;
  LocalBus bus;
  SemanticMapNode node(with_room, bus);
  node.connect(bus);
  std::vector<tile_request_t> requests;
  bus.subscribe<tile_request_t>("TILE_REQUEST", [&](const tile_request_t& m) { requests.push_back(m); });
  const auto vote = [&](const voted_points_t& m) {
    bus.publish("VOTED_POINTS", m);
    bus.dispatch();
  };
  bus.publish("MAP_POSE", pose_at(kStart, 0));
  vote(to_pages(half, 2, 100'000).front());
  node.caught_up(kStart);
  node.tick(kStart + 200'000);
  node.tick(kStart + 2'000'000);  // what was stale is computed
  const std::int64_t later = kStart + 2'000'000 + pipeline::TilePipeline::kAwake;
  node.tick(later);
  for (std::int32_t i = 1; i <= 2; ++i) vote(to_pages(elsewhere, i, 100'000).front());
  for (int i = 0; i < 500 && node.report().counters["far.disk_kb"] == 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  ASSERT_GT(node.report().counters["far.disk_kb"], 0);
  test::truncate_spill_files();

  vote(step_from(2, all, half.points.size()));
  node.tick(later + 200'000);
  bus.dispatch();
  EXPECT_EQ(node.report().counters["faults.far_tiles"], 1);
  ASSERT_EQ(requests.size(), 1U);
  EXPECT_EQ(requests[0].tile_x, (std::vector<std::int32_t>{all.tile_x}));
  EXPECT_EQ(requests[0].have, (std::vector<std::int32_t>{0})) << "the whole tile";
  vote(all);
  EXPECT_EQ(node.report().counters["dropped.gap"], 1);
  EXPECT_EQ(node.report().counters["voted_tiles"], 2 + 2);
}

TEST_F(SemanticMapNodeTest, ANewEpochForgetsTheOldOne) {
  LocalBus bus;
  SemanticMapNode node(config("map.db"), bus);
  node.connect(bus);
  bus.publish("MAP_POSE", pose_at(kStart, 0));
  for (const auto& page : all_pages()) bus.publish("VOTED_POINTS", page);
  bus.dispatch();
  node.tick(kStart + 2'000'000);
  bus.publish("MAP_POSE", pose_at(kStart + 50'000, 0, 2));
  auto page = to_pages(full_tile(), 1, 100'000).front();
  page.epoch = 2;
  bus.publish("VOTED_POINTS", page);
  page.epoch = 1;
  bus.publish("VOTED_POINTS", page);
  bus.dispatch();
  node.finish();
  const store::MapReader map(config("map.db").map);
  EXPECT_EQ(map.epoch(), 2);
  EXPECT_EQ(map.tiles().size(), 1U);
  EXPECT_EQ(map.trajectory().size(), 1U);
  EXPECT_EQ(node.report().counters["dropped.other_epoch"], 1);
}

TEST_F(SemanticMapNodeTest, AnEpochThatOneMessageNamesChangesNothing) {
  LocalBus bus;
  SemanticMapNode node(config("map.db"), bus);
  node.connect(bus);
  bus.publish("MAP_POSE", pose_at(kStart, 0));
  bus.dispatch();
  node.tick(kStart);
  std::int64_t now = kStart;
  for (const auto& page : all_pages()) {
    bus.publish("VOTED_POINTS", page);
    voted_points_t foreign = page;
    foreign.epoch = 9;
    bus.publish("VOTED_POINTS", foreign);
    tile_index_t index{};
    index.owner = "tensor_voting:1";
    index.channel = "VOTED_POINTS";
    index.epoch = 2'147'483'000;
    bus.publish("TILE_INDEX", index);
    bus.publish("MAP_POSE", pose_at(now += 50'000, 0, 1 << 20));  // one bit flipped
    bus.publish("MAP_POSE", pose_at(now += 50'000, 0));
    bus.dispatch();
    node.tick(now);
  }
  node.finish();
  EXPECT_EQ(store::MapReader(config("map.db").map).epoch(), 1);
  EXPECT_EQ(store::MapReader(config("map.db").map).tiles().size(), street().size());
  EXPECT_EQ(node.report().counters["epochs"], 0);
}

TEST_F(SemanticMapNodeTest, LosesNoPoseOfAMapperWhoseClockWasSetBack) {
  LocalBus bus;
  SemanticMapNode node(config("map.db"), bus);
  node.connect(bus);
  node.tick(kStart);
  bus.publish("MAP_POSE", pose_at(kStart, 0, 9));
  for (int i = 0; i < 120; ++i) bus.publish("MAP_POSE", pose_at(kStart + i * 50'000, i, 2));
  bus.dispatch();
  node.tick(kStart);
  EXPECT_EQ(node.report().faults.size(), 2U) << "the clock, and a map begun anew six seconds ago";
  node.finish();
  EXPECT_EQ(store::MapReader(config("map.db").map).epoch(), 2);
  EXPECT_EQ(store::MapReader(config("map.db").map).trajectory().size(), 120U);
}

TEST_F(SemanticMapNodeTest, ARestartGoesOnWithTheDrive) {
  for (int run = 0; run < 2; ++run) {
    LocalBus bus;
    SemanticMapNode node(config("map.db"), bus);
    node.connect(bus);
    bus.publish("MAP_POSE", pose_at(kStart + run * 2'000'000, 0));
    const tile::VotedTile& tile = street()[static_cast<std::size_t>(run)];
    for (const auto& page : to_pages(tile, 2, 400)) bus.publish("VOTED_POINTS", page);
    bus.dispatch();
    node.finish();
  }
  EXPECT_EQ(store::MapReader(config("map.db").map).tiles().size(), 2U);
  {
    LocalBus bus;
    SemanticMapNode node(config("map.db"), bus);
    node.connect(bus);
    bus.publish("MAP_POSE", pose_at(kStart, 0));  // the drive again from its beginning: another one
    bus.dispatch();
    node.finish();
  }
  EXPECT_EQ(store::MapReader(config("map.db").map).tiles().size(), 0U);
}

/// The workers have let go of what lies far from the vehicle: it does not come again.
TEST_F(SemanticMapNodeTest, ARestartKeepsTheLinesOfTilesThatDoNotComeAgain) {
  double length[2] = {};
  const auto length_of = [](const std::vector<tile::CurbLine>& lines, bool beyond) {
    double sum = 0;
    for (const tile::CurbLine& line : lines) {
      for (std::size_t i = 1; i < line.points.size(); ++i) {
        const auto &a = line.points[i - 1], &b = line.points[i];
        if ((a.x > 0) == beyond && (b.x > 0) == beyond) sum += std::hypot(double{b.x - a.x}, double{b.y - a.y});
      }
    }
    return sum;
  };
  for (int run = 0; run < 3; ++run) {
    LocalBus bus;
    SemanticMapNode node(config("map.db"), bus);
    node.connect(bus);
    bus.publish("MAP_POSE", pose_at(kStart + run * 9'000'000, 0));
    for (const tile::VotedTile& tile : street()) {
      if (run > 0 && tile.key.x < 0) continue;
      for (const auto& page : to_pages(tile, 2, 400)) bus.publish("VOTED_POINTS", page);
    }
    bus.dispatch();
    for (int i = 1; i <= 400; ++i) {  // then it is killed
      node.tick(kStart + run * 9'000'000 + 20'000 * i);
      if (i % 50 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(50));  // the file is written meanwhile
    }
    const auto curbs = store::MapReader(config("map.db").map).curbs();
    if (run == 0) length[0] = length_of(curbs, false), length[1] = length_of(curbs, true);
    EXPECT_GT(length[0], 4);
    EXPECT_NEAR(length_of(curbs, false), length[0], 0.5) << run;
    EXPECT_NEAR(length_of(curbs, true), length[1], 0.5) << run;
  }
}

}  // namespace
}  // namespace curbstone::semantic_map
