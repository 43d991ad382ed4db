#include "services/semantic_map/semantic_map_node.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <curbstone/curb_lines_t.hpp>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>

#include "common/local_bus.hpp"
#include "synthetic_ground.hpp"

namespace curbstone {
namespace {

namespace fs = std::filesystem;
constexpr std::int64_t kStart = 1'780'000'000'000'000;

/// Pages of VOTED_POINTS, as a worker sends them.
std::vector<voted_points_t> to_pages(const VotedTile& tile, std::int32_t revision, std::int32_t per_page) {
  std::vector<voted_points_t> pages;
  const auto total = static_cast<std::int32_t>(tile.points.size());
  for (std::int32_t first = 0; first < total; first += per_page) {
    voted_points_t m;
    m.utime = kStart;
    m.epoch = 1;
    m.tile_x = tile.key.x;
    m.tile_y = tile.key.y;
    m.z_origin = tile.z_origin;
    m.chain = 7;
    m.base = 0;
    m.revision = revision;
    m.page = first / per_page;
    m.num_pages = (total + per_page - 1) / per_page;
    m.total = total;
    m.first = first;
    m.num_points = std::min(per_page, total - first);
    m.num_scales = 1;
    m.sigma = {0.3F};
    m.num_voters = m.num_tensors = m.num_points;
    for (std::int32_t i = first; i < first + m.num_points; ++i) {
      const VotedPoint& p = tile.points[static_cast<std::size_t>(i)];
      const auto steps = [](float x) { return static_cast<std::int16_t>(std::clamp(x / 0.002F, 0.0F, 1499.0F)); };
      m.x.push_back(steps(p.x));
      m.y.push_back(steps(p.y));
      m.z.push_back(static_cast<std::int16_t>((p.z - tile.z_origin) / 0.002F));
      m.intensity.push_back(0);
      m.voter.push_back(i);
      m.scale.push_back(0);
      m.point.push_back(i);
      m.normal_x.push_back(static_cast<std::int16_t>(p.normal.x() * 32767));
      m.normal_y.push_back(static_cast<std::int16_t>(p.normal.y() * 32767));
      m.normal_z.push_back(static_cast<std::int16_t>(p.normal.z() * 32767));
      m.tangent_x.push_back(0);
      m.tangent_y.push_back(0);
      m.tangent_z.push_back(0);
      m.stick.push_back(static_cast<std::uint8_t>(p.stick * 255));
      m.plate.push_back(static_cast<std::uint8_t>(p.plate * 255));
      m.mass.push_back(p.mass);
    }
    pages.push_back(m);
  }
  return pages;
}

map_pose_t pose_at(std::int64_t utime, double x, std::int32_t epoch = 1) {
  map_pose_t m{};
  m.utime = utime;
  m.revolution = static_cast<std::int32_t>((utime - kStart) / 50'000);
  m.epoch = epoch;
  m.map_base_position[0] = x;
  m.map_base_orientation[0] = 1;
  return m;
}

class SemanticMapNodeTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("semantic_map_" + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  static const std::vector<VotedTile>& street() {
    static const std::vector<VotedTile> tiles = [] {
      SyntheticCloud cloud;
      cloud.ground(-6, -6, 6, 6, 150, [](double, double y) { return y > 1 ? 0.12 : 0.0; });
      cloud.face(-6, 1, 6, 1, 0, 0.12, 150);
      CloudMapOptions options;
      options.threads = 1;
      CloudMap counts;
      return vote_tiles(cloud.points, options, counts);
    }();
    return tiles;
  }
  /// A tile in the middle. (At the border noise makes some with a point or two.)
  static const VotedTile& full_tile() {
    return *std::max_element(street().begin(), street().end(),
                             [](const auto& a, const auto& b) { return a.points.size() < b.points.size(); });
  }
  static std::vector<voted_points_t> all_pages() {
    std::vector<voted_points_t> pages;
    for (const VotedTile& tile : street()) {
      for (auto& page : to_pages(tile, 2, 400)) pages.push_back(std::move(page));
    }
    return pages;
  }
  SemanticMapConfig config(const std::string& name) const {
    SemanticMapConfig c;
    c.map = name.empty() ? "" : (folder_ / name).string();
    return c;
  }
  static std::string bytes(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  fs::path folder_;
};

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
  const MapReader map(c.map);
  ASSERT_EQ(map.tiles().size(), street().size());
  for (const MapTile& tile : map.tiles()) {
    const semantic_tile_t& m = newest.at(tile.key);
    EXPECT_EQ(m.curbs_utime, m.utime);
    for (std::size_t i = 0; i < kCellsInTile; ++i) {
      EXPECT_EQ(m.cell_class[i], static_cast<std::uint8_t>(tile.cell_class[i]));
      EXPECT_EQ(m.height[i], tile.height[i]);
    }
  }
  EXPECT_EQ(map.curbs().size(), 1U);
  EXPECT_EQ(map.trajectory().size(), 2U);
  EXPECT_GT(fs::file_size(c.picture), 1000U);
  EXPECT_TRUE(node.report().faults.empty());
}

TEST_F(SemanticMapNodeTest, ShowsWhatStandsWhereAtOnceAndLooksForCurbsWhileNothingComes) {
  LocalBus bus;
  SemanticMapNode node(config("map.db"), bus);
  node.connect(bus);
  std::map<TileKey, semantic_tile_t> newest;
  bus.subscribe<semantic_tile_t>("SEMANTIC_TILE", [&](const semantic_tile_t& m) { newest[{m.tile_x, m.tile_y}] = m; });
  const auto curb_cells = [&] {
    std::ptrdiff_t count = 0;
    for (const auto& [key, m] : newest) count += std::count(m.cell_class, m.cell_class + kCellsInTile, +m.CURB);
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
  const MapReader map(config("map.db").map);  // while the service lives: a kill -9 would leave this
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
      for (const VotedTile& tile : street()) {
        VotedTile thin = tile;
        thin.points.resize(thin.points.size() / 2);
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
  const VotedTile& tile = full_tile();
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
  EXPECT_EQ(sent, 1);

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
  EXPECT_EQ(sent, 2);
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
  VotedTile half = full_tile();
  half.points.resize(half.points.size() / 2);
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
    return MapReader(config(name).map).tiles();
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
  const MapReader map(config("map.db").map);
  EXPECT_EQ(map.epoch(), 2);
  EXPECT_EQ(map.tiles().size(), 1U);
  EXPECT_EQ(map.trajectory().size(), 1U);
  EXPECT_EQ(node.report().counters["dropped.old_epoch"], 1);
}

TEST_F(SemanticMapNodeTest, ARestartGoesOnWithTheDrive) {
  for (int run = 0; run < 2; ++run) {
    LocalBus bus;
    SemanticMapNode node(config("map.db"), bus);
    node.connect(bus);
    bus.publish("MAP_POSE", pose_at(kStart + run * 2'000'000, 0));
    const VotedTile& tile = street()[static_cast<std::size_t>(run)];
    for (const auto& page : to_pages(tile, 2, 400)) bus.publish("VOTED_POINTS", page);
    bus.dispatch();
    node.finish();
  }
  EXPECT_EQ(MapReader(config("map.db").map).tiles().size(), 2U);
  {
    LocalBus bus;
    SemanticMapNode node(config("map.db"), bus);
    node.connect(bus);
    bus.publish("MAP_POSE", pose_at(kStart, 0));  // the drive again from its beginning: another one
    bus.dispatch();
    node.finish();
  }
  EXPECT_EQ(MapReader(config("map.db").map).tiles().size(), 0U);
}

TEST_F(SemanticMapNodeTest, RefusesBadPagesByCauseAndLives) {
  LocalBus bus;
  SemanticMapNode node(config(""), bus);
  node.connect(bus);
  const auto good = to_pages(full_tile(), 2, 200).front();
  const auto send = [&](auto change) {
    voted_points_t bad = good;
    change(bad);
    bus.publish("VOTED_POINTS", bad);
    bus.dispatch();
  };
  send([](voted_points_t& m) { m.revision = 0; });
  send([](voted_points_t& m) { m.total = -1; });
  send([](voted_points_t& m) { m.total = 2'000'000'000; });
  send([](voted_points_t& m) { m.first = m.total; });
  send([](voted_points_t& m) { m.first = -5; });
  send([](voted_points_t& m) { m.z_origin = std::nanf(""); });
  send([](voted_points_t& m) { m.x[3] = 1500; });
  send([](voted_points_t& m) { m.y[3] = -1; });
  send([](voted_points_t& m) { m.mass[7] = std::nanf(""); });
  send([](voted_points_t& m) { m.num_scales = 0; });
  send([](voted_points_t& m) { m.base = m.revision + 1; });
  send([](voted_points_t& m) { m.voter[5] = 6; });
  send([](voted_points_t& m) { m.point[5] = m.total; });
  send([](voted_points_t& m) { m.scale[5] = 1; });
  send([](voted_points_t& m) { m.page = m.num_pages; });
  send([](voted_points_t& m) { m.page = 0, m.num_pages = 1; });
  send([](voted_points_t& m) {
    m.num_scales = 2;
    m.sigma = {0.3F, 0.1F};
  });
  const Counters counters = node.report().counters;
  EXPECT_EQ(counters["refused.revision"], 2);
  EXPECT_EQ(counters["refused.size"], 8);
  EXPECT_EQ(counters["refused.voter"], 3);
  EXPECT_EQ(counters["refused.height"], 1);
  EXPECT_EQ(counters["refused.position"], 2);
  EXPECT_EQ(counters["refused.mass"], 1);

  map_pose_t pose = pose_at(kStart, 0);
  pose.map_base_position[1] = std::nan("");
  bus.publish("MAP_POSE", pose);
  bus.dispatch();
  EXPECT_EQ(node.report().counters["refused.pose"], 1);
  node.tick(kStart);
  node.finish();
}

TEST_F(SemanticMapNodeTest, RandomValuesInMessagesDoNoHarm) {
  LocalBus bus;
  SemanticMapNode node(config(""), bus);
  node.connect(bus);
  const auto good = to_pages(full_tile(), 2, 100).front();
  std::mt19937 random(3);
  const auto any = [&] { return static_cast<std::int32_t>(random() >> random() % 32); };
  for (int i = 0; i < 3000; ++i) {
    voted_points_t m = good;
    std::int32_t* fields[] = {&m.tile_x,
                              &m.tile_y,
                              &m.revision,
                              &m.total,
                              &m.first,
                              &m.base,
                              &m.page,
                              &m.num_pages,
                              &m.voter.front(),
                              &m.voter[9],
                              &m.point[random() % 50]};
    *fields[random() % std::size(fields)] = any();
    if (i % 50 == 0) m.epoch = i / 50;
    const std::size_t k = random() % m.x.size();
    m.x[k] = static_cast<std::int16_t>(any());
    m.z[k] = static_cast<std::int16_t>(any());
    m.normal_x[k] = m.normal_y[k] = m.normal_z[k] = static_cast<std::int16_t>(any());
    if (i % 7 == 0) m.z_origin = std::bit_cast<float>(any());
    if (i % 11 == 0) m.sigma[0] = std::bit_cast<float>(any());
    if (i % 2 == 0) {  // half of them complete a tile
      m.total = m.num_points;
      m.num_pages = 1;
    }
    bus.publish("VOTED_POINTS", m);
    bus.dispatch();
    if (i % 100 == 0) node.tick(kStart + i * 20'000);
  }
  node.finish();
  EXPECT_GT(node.report().counters["voted_tiles"], 10);
  EXPECT_GT(node.report().counters["refused.size"], 10);
}

TEST_F(SemanticMapNodeTest, RefusesToStartOnAFileThatIsNoMap) {
  std::ofstream(folder_ / "map.db") << "not a map, and long enough to be read as a header of one, is it not?";
  LocalBus bus;
  EXPECT_THROW(SemanticMapNode(config("map.db"), bus), MapStoreError);
}

}  // namespace
}  // namespace curbstone
