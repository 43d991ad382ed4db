#include "services/semantic_map/semantic_map_node.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <curbstone/curb_lines_t.hpp>
#include <curbstone/marking_lines_t.hpp>
#include <map>
#include <random>

#include "common/bus/local_bus.hpp"
#include "tests/services/semantic_map/semantic_map_node_test.hpp"

namespace curbstone::semantic_map {
namespace {

TEST_F(SemanticMapNodeTest, SaysWhereTheRoadIsPaintedAndKeepsItInTheMapFile) {
  LocalBus bus;
  const SemanticMapConfig c = config("map.db");
  SemanticMapNode node(c, bus);
  node.connect(bus);
  std::vector<marking_lines_t> markings;
  bus.subscribe<marking_lines_t>("MARKINGS", [&](const marking_lines_t& m) { markings.push_back(m); });
  bus.publish("MAP_POSE", pose_at(kStart, 0));
  for (voted_points_t page : all_pages()) {
    for (std::size_t i = 0; i < page.intensity.size(); ++i) {
      const double y = page.tile_y * kTileSize + page.y[i] * kPositionStep;
      page.intensity[i] = std::abs(y + 2.0) < 0.12 ? 160 : 64;
    }
    bus.publish("VOTED_POINTS", page);
  }
  bus.publish("MAP_POSE", pose_at(kStart + 50'000, 1));
  bus.dispatch();
  for (int i = 1; i <= 350; ++i) {
    node.tick(kStart + 20'000 * i);
    bus.dispatch();
  }
  ASSERT_FALSE(markings.empty());
  EXPECT_LE(markings.size(), 7U) << "no more than one a second";
  ASSERT_EQ(markings.back().num_lines, 1);
  const marking_line_t& line = markings.back().lines[0];
  EXPECT_EQ(int{line.type}, int{marking_line_t::SOLID});
  EXPECT_GT(std::abs(line.x.back() - line.x.front()), 10.0F);
  for (const float y : line.y) EXPECT_NEAR(y, -2.0F, 0.05F);
  const std::size_t sent = markings.size();
  node.finish();
  EXPECT_EQ(markings.size(), sent) << "and what was sent is the map";
  const auto kept = store::MapReader(c.map).markings();
  ASSERT_EQ(kept.size(), 1U);
  EXPECT_EQ(kept[0].points.size(), line.x.size());
}

/// The driveway between two curbs has a bright stripe, where its stones are.
std::vector<voted_points_t> driveway_pages() {
  SyntheticCloud cloud;
  const auto is_curb = [](double x) { return std::abs(x) > 1.9; };
  cloud.ground(-9, -6, 9, 6, 150, [&](double x, double y) { return y > 1 && is_curb(x) ? 0.12 : 0.0; });
  cloud.face(-9, 1, -1.9, 1, 0, 0.12, 150);
  cloud.face(1.9, 1, 9, 1, 0, 0.12, 150);
  detect::cloud_map::CloudMapOptions options;
  options.threads = 1;
  detect::cloud_map::CloudMap counts;
  std::vector<voted_points_t> pages;
  for (const tile::VotedTile& tile : detect::cloud_map::vote_tiles(cloud.points, options, counts)) {
    for (voted_points_t& page : to_pages(tile, 2, 400)) {
      for (std::size_t i = 0; i < page.intensity.size(); ++i) {
        const double x = page.tile_x * kTileSize + page.x[i] * kPositionStep;
        const double y = page.tile_y * kTileSize + page.y[i] * kPositionStep;
        const bool is_stone = std::abs(x) < 1.7 && y > 1 && y < 1.15;
        page.intensity[i] = is_stone || std::abs(y + 2) < 0.08 ? 160 : 64;
      }
      pages.push_back(std::move(page));
    }
  }
  return pages;
}

/// What MARKINGS said last, as bytes. Revision and ids say how often and in which order a node has said something.
std::vector<std::uint8_t> bytes_of(marking_lines_t message) {
  message.revision = 0;
  for (marking_line_t& line : message.lines) line.id = 0;
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, message.getEncodedSize());
  return bytes;
}

TEST_F(SemanticMapNodeTest, ItsLastMarkingsAreTheSameLiveAndInAReplay) {
  const std::vector<voted_points_t> pages = driveway_pages();
  const auto drive = [&](bool is_live) {
    LocalBus bus;
    const SemanticMapConfig c = config("");
    SemanticMapNode node(c, bus);
    node.connect(bus);
    std::vector<marking_lines_t> markings;
    bus.subscribe<marking_lines_t>("MARKINGS", [&](const marking_lines_t& m) { markings.push_back(m); });
    std::int64_t now = kStart;
    const auto pass = [&](int ticks) {
      for (int i = 0; i < ticks; ++i) {
        now += 20'000;
        bus.dispatch();
        node.tick(now);
        while (is_live && node.idle(now)) {
        }
      }
    };
    bus.publish("MAP_POSE", pose_at(kStart, 0));
    bus.publish("MAP_POSE", pose_at(kStart + 50'000, 1));
    // The curb beyond the driveway comes last: until then nothing tells stone from paint.
    for (const bool is_last : {false, true}) {
      for (const voted_points_t& page : pages) {
        if ((page.tile_x > 0) != is_last) continue;
        bus.publish("VOTED_POINTS", page);
        if (is_live) pass(1);
      }
      pass(is_live ? 400 : 1);
    }
    bus.publish("MAP_POSE", pose_at(kStart + 60'000'000, 3));
    bus.dispatch();
    node.finish();
    bus.dispatch();
    return markings;
  };
  const auto live = drive(true);
  const auto replay = drive(false);
  ASSERT_GT(live.size(), replay.size()) << "the two are sent in other steps";
  ASSERT_FALSE(replay.empty());
  EXPECT_EQ(replay.back().num_lines, 1) << "the line along the street";
  EXPECT_EQ(bytes_of(live.back()), bytes_of(replay.back()));
}

TEST_F(SemanticMapNodeTest, MakesTilesCurbsAndAMapFile) {
  LocalBus bus;
  SemanticMapConfig c = config("map.db");
  c.picture = (folder_ / "map.png").string();
  SemanticMapNode node(c, bus);
  node.connect(bus);
  std::vector<semantic_tile_t> tiles;
  std::vector<curb_lines_t> curbs;
  std::vector<tile_index_t> indices;
  bus.subscribe<semantic_tile_t>("SEMANTIC_TILE", [&](const semantic_tile_t& m) { tiles.push_back(m); });
  bus.subscribe<curb_lines_t>("CURBS", [&](const curb_lines_t& m) { curbs.push_back(m); });
  bus.subscribe<tile_index_t>("TILE_INDEX", [&](const tile_index_t& m) { indices.push_back(m); });

  bus.publish("MAP_POSE", pose_at(kStart, 0));
  for (const auto& page : all_pages()) bus.publish("VOTED_POINTS", page);
  bus.publish("MAP_POSE", pose_at(kStart + 50'000, 1));
  bus.dispatch();
  std::map<TileKey, semantic_tile_t> newest;
  std::size_t sent_early = 0;
  for (int i = 1; i <= 350; ++i) {
    node.tick(kStart + 20'000 * i);
    bus.dispatch();
    if (i == 250) sent_early = tiles.size();
  }
  for (const semantic_tile_t& m : tiles) {
    const auto [it, is_first] = newest.try_emplace({m.tile_x, m.tile_y}, m);
    if (is_first) continue;
    EXPECT_GT(m.revision, it->second.revision);
    it->second = m;
  }
  EXPECT_EQ(newest.size(), street().size());
  EXPECT_EQ(tiles.size(), sent_early) << "nothing changes any more";
  ASSERT_FALSE(curbs.empty());
  ASSERT_EQ(curbs.back().num_lines, 1);
  const curb_line_t& line = curbs.back().lines[0];
  EXPECT_GT(line.num_points, 25);
  EXPECT_EQ(line.rise, 1) << "up from the road that was driven on";
  for (const float y : line.y) EXPECT_NEAR(y, 1.0F, 0.06F);
  EXPECT_NEAR(line.height[5], 0.12F, 0.02F);
  EXPECT_GT(line.high_side_y[5], 0.9F);
  EXPECT_GE(indices.size(), 2U);
  EXPECT_EQ(indices.back().num_tiles, static_cast<std::int32_t>(street().size()));
  node.finish();

  EXPECT_EQ(tiles.size(), sent_early) << "and what was sent is the map";
  const store::MapReader map(c.map);
  ASSERT_EQ(map.tiles().size(), street().size());
  for (const tile::MapTile& tile : map.tiles()) {
    const semantic_tile_t& m = newest.at(tile.key);
    EXPECT_EQ(m.curbs_utime, m.utime);
    for (std::size_t i = 0; i < tile::kCellsInTile; ++i) {
      EXPECT_EQ(m.cell_class[i], static_cast<std::uint8_t>(tile.cell_class[i]));
      EXPECT_EQ(m.height[i], tile.height[i]);
    }
  }
  EXPECT_EQ(map.curbs().size(), 1U);
  EXPECT_EQ(map.trajectory().size(), 2U);
  EXPECT_GT(fs::file_size(c.picture), 1000U);
  EXPECT_TRUE(node.report().faults.empty());
}

TEST_F(SemanticMapNodeTest, SaysNothingOfCurbsAndMarkingsWhileThereAreNoPointsToSayItsTime) {
  LocalBus bus;
  SemanticMapNode node(config(""), bus);
  node.connect(bus);
  int said = 0;
  bus.subscribe<curb_lines_t>("CURBS", [&](const curb_lines_t&) { ++said; });
  bus.subscribe<marking_lines_t>("MARKINGS", [&](const marking_lines_t&) { ++said; });
  for (int i = 1; i <= 100; ++i) {
    bus.publish("MAP_POSE", pose_at(kStart + 20'000 * i, 0.1 * i));
    node.tick(kStart + 20'000 * i);
    bus.dispatch();
  }
  node.finish();
  bus.dispatch();
  EXPECT_EQ(said, 0);
}

TEST_F(SemanticMapNodeTest, CurbsOfTilesThatGoOnChangingAreSaidFiveTimesASecond) {
  LocalBus bus;
  SemanticMapNode node(config(""), bus);
  node.connect(bus);
  std::vector<std::int64_t> said;
  std::int64_t now = kStart;
  bus.subscribe<curb_lines_t>("CURBS", [&](const curb_lines_t&) { said.push_back(now); });
  const auto pages = all_pages();
  for (std::size_t i = 0; i < 100; ++i, now += 20'000) {
    if (i % 5 == 0 && i / 5 < pages.size()) bus.publish("VOTED_POINTS", pages[i / 5]);
    bus.dispatch();
    node.tick(now);
    bus.dispatch();
  }
  ASSERT_GE(said.size(), 3U);
  for (std::size_t i = 1; i < said.size(); ++i) EXPECT_GE(said[i] - said[i - 1], 200'000);
  EXPECT_LE(said[1] - said[0], 400'000);
}

TEST_F(SemanticMapNodeTest, ShowsWhatStandsWhereAtOnceAndLooksForCurbsWhileNothingComes) {
  LocalBus bus;
  SemanticMapNode node(config("map.db"), bus);
  node.connect(bus);
  std::map<TileKey, semantic_tile_t> newest;
  bus.subscribe<semantic_tile_t>("SEMANTIC_TILE", [&](const semantic_tile_t& m) { newest[{m.tile_x, m.tile_y}] = m; });
  const auto curb_cells = [&] {
    std::ptrdiff_t count = 0;
    for (const auto& [key, m] : newest) count += std::count(m.cell_class, m.cell_class + tile::kCellsInTile, +m.CURB);
    return count;
  };
  for (const auto& page : all_pages()) bus.publish("VOTED_POINTS", page);
  bus.dispatch();
  node.caught_up(kStart);
  bus.dispatch();
  EXPECT_EQ(newest.size(), street().size());
  for (const auto& [key, m] : newest) EXPECT_EQ(m.curbs_utime, 0) << "none were looked for yet";
  EXPECT_EQ(curb_cells(), 0);

  std::int64_t now = kStart;
  EXPECT_TRUE(node.idle(now)) << "a piece";
  bus.dispatch();
  EXPECT_LE(node.report().counters["evidence_computed"], 1) << "one tile's, no more";
  for (int i = 0; i < 350; ++i) {
    while (node.idle(now)) continue;
    node.tick(now += 20'000);
    bus.dispatch();
  }
  for (const auto& [key, m] : newest) EXPECT_EQ(m.curbs_utime, m.utime);
  EXPECT_GT(curb_cells(), 50);
}

TEST_F(SemanticMapNodeTest, StoresTheCurbsDuringTheDriveToo) {
  LocalBus bus;
  SemanticMapNode node(config("map.db"), bus);
  node.connect(bus);
  bus.publish("MAP_POSE", pose_at(kStart, 0));
  for (const auto& page : all_pages()) bus.publish("VOTED_POINTS", page);
  bus.dispatch();
  for (int i = 1; i <= 400; ++i) node.tick(kStart + 20'000 * i);
  const store::MapReader map(config("map.db").map);  // while the service lives: a kill -9 would leave this
  ASSERT_EQ(map.curbs().size(), 1U);
  EXPECT_GT(map.curbs()[0].points.size(), 20U);
  EXPECT_EQ(map.tiles().size(), street().size());
}

TEST_F(SemanticMapNodeTest, TheMapFileDoesNotDependOnTheOrderOfMessagesNorOnTicks) {
  for (unsigned seed = 0; seed < 3; ++seed) {
    LocalBus bus;
    SemanticMapNode node(config("map" + std::to_string(seed) + ".db"), bus);
    node.connect(bus);
    std::vector<voted_points_t> pages = all_pages();
    if (seed > 0) {
      // An older revision of everything, twice; then all pages of both, shuffled.
      for (const tile::VotedTile& tile : street()) {
        tile::VotedTile thin = tile;
        thin.points.shorten(thin.points.size() / 2);
        for (const auto& page : to_pages(thin, 1, 300)) pages.insert(pages.end(), 2, page);
      }
      std::shuffle(pages.begin(), pages.end(), std::mt19937(seed));
    }
    std::int64_t now = kStart;
    bus.publish("MAP_POSE", pose_at(now, 0));
    for (std::size_t i = 0; i < pages.size(); ++i) {
      bus.publish("VOTED_POINTS", pages[i]);
      bus.dispatch();
      if (seed > 0 && i % (2 + seed) == 0) node.tick(now += 20'000);
    }
    for (const auto& page : all_pages()) bus.publish("VOTED_POINTS", page);  // what was superseded comes again
    bus.publish("MAP_POSE", pose_at(kStart + 900'000, 1));
    bus.dispatch();
    node.finish();
  }
  const std::string first = bytes(folder_ / "map0.db");
  EXPECT_FALSE(first.empty());
  EXPECT_TRUE(first == bytes(folder_ / "map1.db"));
  EXPECT_TRUE(first == bytes(folder_ / "map2.db"));
}

}  // namespace
}  // namespace curbstone::semantic_map
