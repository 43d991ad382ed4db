#include "services/tensor_voting/worker/tensor_voting_node.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <set>
#include <stdexcept>

#include "tests/services/tensor_voting/worker/tensor_voting_world.hpp"

namespace curbstone::tensor_voting::worker {
namespace {

TEST(TensorVotingNode, PublishesEveryPointOfTheMapWithItsTensorsAtEveryScale) {
  World world(street(), 0, 1, two_scales());
  world.start("tensor_voting:1");
  int longest = 0;
  world.bus.subscribe<voted_points_t>(
      "VOTED_POINTS", [&](const voted_points_t& m) { longest = std::max(longest, m.getEncodedSize()); });
  world.run(3, 0.1);
  world.finish();
  ASSERT_EQ(world.listener.tiles().size(), world.mapper.tiles().size());
  for (const auto& [key, tile] : world.listener.tiles()) {
    const auto& points = world.mapper.tiles().at(key);
    const voted_points_t all = tile.finished();
    EXPECT_EQ(all.num_scales, 2);
    EXPECT_EQ(all.sigma, (std::vector<float>{0.3F, 0.1F}));
    EXPECT_EQ(all.total, static_cast<std::int32_t>(points.size()));
    ASSERT_EQ(all.x.size(), points.size());
    for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(all.x[i], points[i].x);
    std::set<std::pair<int, std::int32_t>> with_tensor;
    for (std::size_t i = 0; i < all.point.size(); ++i) with_tensor.insert({all.scale[i], all.point[i]});
    for (std::size_t i = 0; i < all.voter.size(); ++i) {
      const int scale = i < points.size() ? 0 : 1;
      EXPECT_TRUE(with_tensor.contains({scale, all.voter[i]}));
    }
  }
  EXPECT_LE(longest, 48 * 1024);
  // The road at the vehicle: a horizontal plane, well voted.
  const voted_points_t road = world.listener.tiles().at({0, 0}).finished();
  int flat = 0;
  int voters = 0;
  for (std::size_t i = 0; i < road.point.size(); ++i) {
    if (road.scale[i] != 0) continue;
    ++voters;
    flat += road.normal_z[i] > 32000 && road.stick[i] > 90 && road.mass[i] > 5;
  }
  EXPECT_GT(flat, voters * 8 / 10);
}

TEST(TensorVotingNode, SendsWhatHasChangedAndNotTheTileAnew) {
  World world(street());
  world.start("tensor_voting:1");
  std::size_t sent = 0;
  std::map<std::pair<int, int>, int> wholes;
  world.bus.subscribe<voted_points_t>("VOTED_POINTS", [&](const voted_points_t& m) {
    sent += static_cast<std::size_t>(m.num_points);
    if (m.base == 0 && m.page == 0) ++wholes[{m.tile_x, m.tile_y}];
  });
  world.run(3, 0.1);
  world.run(2);
  EXPECT_EQ(world.listener.contents(), lossless());
  EXPECT_EQ(world.listener.gaps, 0);
  EXPECT_EQ(sent, 20'000U) << "no point goes twice";
  for (const auto& [key, count] : wholes) EXPECT_EQ(count, 1) << "the first step";
}

TEST(TensorVotingNode, WhoeverComesLateGetsWholeTilesAndGoesOnFromThere) {
  World world(street());
  world.start("tensor_voting:1");
  world.run(2, 0.02);
  test_world::Listener late(world.bus, world.publisher);
  for (int i = 0; i < 200; ++i) {
    world.run(0.02, i < 100 ? 0.01 : 0);
    late.tick(world.now);
  }
  world.mapper.map(world.now, 1.0);
  for (int i = 0; i < 150; ++i) {
    world.run(0.02);
    late.tick(world.now);
  }
  EXPECT_EQ(late.contents(), lossless());
  EXPECT_GT(late.gaps, 0) << "it heard of steps before";
}

TEST(TensorVotingNode, TheFinalContentDoesNotDependOnPacing) {
  World world(street());
  world.start("tensor_voting:1");
  world.run(3, 0.07);
  world.run(4);
  EXPECT_EQ(world.listener.contents(), lossless()) << "also without finish()";
}

TEST(TensorVotingNode, ConvergesBitForBitThroughLossDoublesAndDisorder) {
  for (unsigned seed = 1; seed <= 2; ++seed) {
    World world(street(), 0.5, seed);
    world.start("tensor_voting:1");
    world.run(4, 0.05);
    world.publisher.heal();
    world.run(6);
    EXPECT_EQ(world.listener.contents(), lossless()) << "seed " << seed;
    EXPECT_GT(world.nodes.begin()->second->report().counters["dropped.gap"], 0) << "there was trouble";
  }
}

TEST(TensorVotingNode, ANewEpochForgetsTheOldMap) {
  World world(test_clouds::as_tiles(test_clouds::street(5'000, 9)));
  world.start("tensor_voting:1");
  world.run(1, 0.3);
  world.mapper.start_epoch(2, street());
  world.listener.start_epoch(2);
  world.run(2, 0.2);
  world.finish();
  auto contents = world.listener.contents();
  EXPECT_EQ(contents.size(), lossless().size());
  for (const auto& [key, tile] : world.listener.tiles()) {
    EXPECT_EQ(tile.all.total, static_cast<std::int32_t>(world.mapper.tiles().at(key).size()));
  }
  const std::int64_t dropped = world.nodes.begin()->second->report().counters["dropped.other_epoch"];
  map_points_t old{};
  old.epoch = 1;
  world.bus.publish("MAP_POINTS", old);
  world.bus.dispatch();
  EXPECT_EQ(world.nodes.begin()->second->report().counters["dropped.other_epoch"], dropped + 1);
}

TEST(TensorVotingNode, AnEpochThatOneMessageNamesChangesNothing) {
  World world(street());
  world.start("tensor_voting:1");
  world.run(2, 0.2);
  for (const std::int32_t epoch : {2, 3, 2'147'483'000, -5}) {
    tile_index_t index{};
    index.owner = "mapper";
    index.channel = "MAP_POINTS";
    index.epoch = epoch;
    index.num_pages = 1;
    world.bus.publish("TILE_INDEX", index);
    map_points_t points{};
    points.epoch = epoch + 7;
    world.bus.publish("MAP_POINTS", points);
    world.run(1);
  }
  world.run(2);
  EXPECT_EQ(world.listener.contents(), lossless());
}

TEST(TensorVotingNode, KeepsToItsBandwidthAndToFiveRevisionsASecond) {
  TensorVotingConfig config = two_scales();
  config.bandwidth = 0.5;
  World world(street(), 0, 1, config);
  world.start("tensor_voting:1");
  std::int64_t bytes_in_tick = 0;
  std::int64_t most = 0;
  std::map<std::pair<std::int32_t, std::int32_t>, int> revisions;
  world.bus.subscribe<voted_points_t>("VOTED_POINTS", [&](const voted_points_t& m) {
    bytes_in_tick += m.getEncodedSize();
    if (m.page == 0) ++revisions[{m.tile_x, m.tile_y}];
  });
  std::int64_t total = 0;
  for (int i = 0; i < 150; ++i) {
    bytes_in_tick = 0;
    world.run(0.02, i < 100 ? 0.05 : 0);
    most = std::max(most, bytes_in_tick);
    total += bytes_in_tick;
  }
  EXPECT_LE(most, 2 * 48 * 1024) << "no bursts";
  EXPECT_LE(total, 0.5e6 * 3 + 48 * 1024);
  EXPECT_GT(total, 0.5e6 * 2);
  for (const auto& [key, count] : revisions) EXPECT_LE(count, 15) << "in 3 s";
}

TEST(TensorVotingNode, ThatIsFullSaysSoAsksForNothingAndTakesTheRestOnceThereIsRoom) {
  TensorVotingConfig config;
  config.keep_radius = 50;
  config.max_points = 12'000;  // of 20,000
  World world(street(), 0, 1, config);
  TensorVotingNode& node = world.start("tensor_voting:1");
  int asked = 0;
  world.bus.subscribe<tile_request_t>("TILE_REQUEST", [&](const tile_request_t& m) {
    if (m.channel == "MAP_POINTS") asked += m.num_tiles;
  });
  const auto says_so = [&] {
    return testing::Value(node.report().faults, testing::Contains(testing::HasSubstr("max_points reached: ")));
  };
  world.run(1, 0.2);
  world.run(3);
  EXPECT_TRUE(says_so());
  EXPECT_GE(node.report().counters["dropped.full"], 8000) << "records, not messages";
  asked = 0;
  world.run(5);
  EXPECT_EQ(asked, 0) << "it would not fit";
  const auto drive_to = [&](double x) {
    map_pose_t pose{};
    pose.epoch = 1;
    pose.map_base_position[0] = x;
    world.bus.publish("MAP_POSE", pose);
    world.run(3);
  };
  drive_to(200);
  EXPECT_FALSE(says_so());
  drive_to(56);
  EXPECT_FALSE(says_so()) << "the street's end fits";
  EXPECT_GT(asked, 0);
}

TEST(TensorVotingNode, LetsGoOfTilesFarBehindAndTakesThemUpAgain) {
  TensorVotingConfig config;
  config.keep_radius = 50;
  World world(street(), 0, 1, config);
  TensorVotingNode& node = world.start("tensor_voting:1");
  world.run(1, 0.2);
  world.run(3);
  EXPECT_EQ(world.listener.contents(), lossless());
  const auto drive_to = [&](double x) {
    map_pose_t pose{};
    pose.epoch = 1;
    pose.map_base_position[0] = x;
    world.bus.publish("MAP_POSE", pose);
    world.run(2);
  };
  drive_to(200);
  EXPECT_EQ(node.report().counters["tiles_let_go"], static_cast<std::int64_t>(lossless().size()));
  const int before = world.listener.messages;
  drive_to(0);
  world.run(3);
  EXPECT_EQ(world.listener.contents(), lossless());
  EXPECT_EQ(world.listener.messages, before) << "nothing has changed: nothing is published again";
}

/// As after a loop has been closed: the drive begins anew in another epoch, and most of it is far from the vehicle.
TEST(TensorVotingNode, WhatNobodyHasPublishedYetIsVotedHoweverFarAndThenLetGo) {
  TensorVotingConfig config;
  config.keep_radius = 50;
  for (const double trouble : {0.0, 0.1}) {
    World world(street(), trouble, 3, config);
    TensorVotingNode& node = world.start("tensor_voting:1");
    world.mapper.vehicle_x = 200;
    world.run(3, 0.05);
    world.run(20);
    EXPECT_EQ(world.listener.contents(), lossless()) << trouble;
    EXPECT_EQ(node.report().counters["tiles_let_go"], static_cast<std::int64_t>(lossless().size())) << trouble;
  }
}

TEST(TensorVotingNode, AFarTileIsVotedWithItsNeighboursThoughTheseAreOut) {
  TensorVotingConfig config;
  config.keep_radius = 50;
  World world(street(), 0, 1, config);
  TensorVotingNode& node = world.start("tensor_voting:2");
  world.mapper.vehicle_x = 200;
  world.run(0.1);
  const TileKey key = std::next(lossless().begin(), 20)->first;
  tile_index_t published{};  // all but one, by a worker that is heard no more
  published.owner = "tensor_voting:1";
  published.channel = "VOTED_POINTS";
  published.epoch = 1;
  published.num_pages = 1;
  for (const auto& [known, content] : lossless()) {
    if (known == key) continue;
    published.tile_x.push_back(known.x);
    published.tile_y.push_back(known.y);
    published.version.push_back(2'000'000'000);
  }
  published.num_tiles = static_cast<std::int32_t>(published.version.size());
  map_pose_t pose{};
  pose.epoch = 1;
  pose.map_base_position[0] = 200;
  world.bus.publish("MAP_POSE", pose);
  world.bus.publish("TILE_INDEX", published);
  world.run(1, 0.2);
  world.run(25);
  const auto contents = world.listener.contents();
  ASSERT_EQ(contents.size(), 1U);
  EXPECT_EQ(contents.begin()->first, key);
  EXPECT_EQ(contents.begin()->second, lossless().at(key));
  EXPECT_EQ(node.report().counters["tiles_let_go"], 9);
}

TEST(TensorVotingNode, RefusesNonsenseAndGoesOn) {
  World world(street());
  TensorVotingNode& node = world.start("tensor_voting:1");
  map_points_t good{};
  good.epoch = 1;
  good.num_points = 1;
  good.x = {5};
  good.y = {5};
  good.z = {5};
  good.intensity = {0};
  std::vector<map_points_t> bad(6, good);
  bad[0].x = {1500};
  bad[1].y = {-1};
  bad[2].tile_x = 2'000'000'000;
  bad[3].z_origin = std::nanf("");
  bad[4].z_origin = 0.5F;
  bad[5].first = -1;
  for (const auto& m : bad) world.bus.publish("MAP_POINTS", m);
  map_pose_t pose{};
  pose.map_base_position[0] = std::nan("");
  world.bus.publish("MAP_POSE", pose);
  world.bus.dispatch();
  const Counters counters = node.report().counters;
  EXPECT_EQ(counters["refused.map_points"] + counters["dropped.far"], 6);
  EXPECT_EQ(counters["refused.map_pose"], 1);

  std::mt19937 random(1);
  for (int i = 0; i < 3000; ++i) {  // truncated, flipped and random messages
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(good.getEncodedSize()));
    good.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    if (i % 3 == 0) bytes.resize(random() % bytes.size());
    if (i % 3 == 1) bytes[random() % bytes.size()] ^= static_cast<std::uint8_t>(1 << (random() % 8));
    if (i % 3 == 2)
      for (auto& b : bytes) b = static_cast<std::uint8_t>(random());
    for (const char* channel : {"MAP_POINTS", "TILE_INDEX", "TILE_REQUEST", "MAP_POSE"}) {
      world.bus.inject(channel, bytes.data(), static_cast<int>(bytes.size()));
    }
    world.bus.dispatch();
    node.tick(world.now += kTick);
  }
}

TEST(TensorVotingNode, RefusesScalesThatCannotBeVoted) {
  LocalBus bus;
  TensorVotingConfig config;
  config.sigma = {0.3, 0.1};
  config.voxel = {0.1};
  EXPECT_THROW(TensorVotingNode(config, "w", bus), std::invalid_argument);
  config.sigma = {0.3};
  config.voxel = {0.07};
  EXPECT_THROW(TensorVotingNode(config, "w", bus), std::invalid_argument);
  config.voxel = {0.1};
  EXPECT_NO_THROW(TensorVotingNode(config, "w", bus));
}

}  // namespace
}  // namespace curbstone::tensor_voting::worker
