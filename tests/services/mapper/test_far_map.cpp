#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <curbstone/lidar_points_t.hpp>
#include <curbstone/map_points_t.hpp>
#include <curbstone/odometry_t.hpp>
#include <curbstone/tile_index_t.hpp>
#include <curbstone/tile_request_t.hpp>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/local_bus.hpp"
#include "services/mapper/mapper_node.hpp"
#include "services/mapper/storage/map_folder.hpp"
#include "tests/damaged_spill_files.hpp"
#include "tests/services/mapper/round_street.hpp"
#include "tests/services/mapper/storage/saved_map_fixture.hpp"
#include "tests/temporary_folder.hpp"

/// @file
/// A mapper's node whose map is in the file of far tiles but for a few, beside one that has all of it in memory.

namespace curbstone::mapper {
namespace {

constexpr double kTurn = 0.05;    // s
constexpr int kOnceAround = 300;  // turns, until the loop is closed and the map has moved

std::int64_t at(double seconds) {
  return test::SyntheticWorld::kEpoch + std::llround(seconds * 1e6);
}

config::MapperConfig few_in_memory(const std::string& far_folder) {
  config::MapperConfig config;
  test::forget_soon(config);
  test::keep_little_in_memory(config, far_folder);
  return config;
}

using Records = std::map<TileKey, std::vector<TilePoint>>;

/// Who puts tiles together from what it hears, in the newest epoch.
struct Hearer {
  std::int32_t epoch = 0;
  Records tiles;
  std::map<TileKey, std::int32_t> announced;
  bool gap = false;
  int epochs = 0;

  explicit Hearer(LocalBus& bus) {
    bus.subscribe<map_points_t>("MAP_POINTS", [this](const map_points_t& m) { on(m); });
    bus.subscribe<tile_index_t>("TILE_INDEX", [this](const tile_index_t& m) { on(m); });
  }
  void enter(std::int32_t newer) {
    if (newer <= epoch) return;
    epoch = newer;
    ++epochs;
    tiles.clear();
    announced.clear();
  }
  void on(const tile_index_t& m) {
    if (m.channel != "MAP_POINTS") return;
    enter(m.epoch);
    for (std::size_t i = 0; i < m.tile_x.size(); ++i) announced[{m.tile_x[i], m.tile_y[i]}] = m.version[i];
  }
  void on(const map_points_t& m) {
    enter(m.epoch);
    if (m.epoch < epoch) return;
    std::vector<TilePoint>& points = tiles[{m.tile_x, m.tile_y}];
    gap = gap || m.first > static_cast<std::int32_t>(points.size());
    for (auto i = points.size() - static_cast<std::size_t>(m.first); i < m.x.size(); ++i)
      points.push_back({m.x[i], m.y[i], m.z[i], m.intensity[i]});
  }
};

class FarMap {
 public:
  explicit FarMap(const config::MapperConfig& config) : node_(config, bus_) { node_.connect(bus_); }
  void drive(int turns) {
    static const test::SyntheticWorld world = test::round_street();
    for (const int end = turn_ + turns; turn_ < end; ++turn_) {
      for (; odometry_sent_ < (turn_ + 1) * kTurn + 0.02; odometry_sent_ += 0.01) {
        odometry_t m{};
        m.utime = at(odometry_sent_);
        m.flags = odometry_t::INITIALISED;
        pose_to_arrays(test::around(0).inverse() * test::around(odometry_sent_), m.position, m.orientation);
        bus_.publish("ODOMETRY", m);
      }
      for (const auto& packet : world.packets(test::around, test::default_lidar(), turn_, turn_ * kTurn, kTurn))
        bus_.publish("LIDAR_POINTS", packet);
      bus_.dispatch();
      tick(2);
    }
  }
  void tick(int times) {
    for (int i = 0; i < times; ++i) {
      node_.tick(now_ = std::max(now_ + 20'000, at(turn_ * kTurn)));
      bus_.dispatch();
    }
  }
  void request_all(const Hearer& late) {
    tile_request_t request{};
    request.channel = "MAP_POINTS";
    request.epoch = late.epoch;
    for (const auto& [key, version] : late.announced) {
      request.tile_x.push_back(key.x);
      request.tile_y.push_back(key.y);
      request.have.push_back(0);
    }
    request.num_tiles = static_cast<std::int32_t>(request.have.size());
    bus_.publish("TILE_REQUEST", request);
    bus_.dispatch();
    tick(2 * request.num_tiles);
  }
  void finish() {
    node_.finish();
    bus_.dispatch();
  }
  [[nodiscard]] Records records() const {
    Records all;
    const dense_map::DenseMap& map = node_.mapper().grown();
    for (const TileKey& key : map.keys()) {
      std::vector<TilePoint> records = map.tile(key)->read()->records;
      if (!records.empty()) all.emplace(key, std::move(records));
    }
    return all;
  }
  [[nodiscard]] int num_away() const {
    const dense_map::DenseMap& map = node_.mapper().grown();
    int spilled = 0;
    for (const TileKey& key : map.keys()) spilled += map.tile(key)->is_spilled() ? 1 : 0;
    return spilled;
  }
  [[nodiscard]] std::int64_t counter(const std::string& name) const { return node_.report().counters[name]; }
  /// So that none of them waits in memory.
  void expect_on_the_disk() {
    tick(4);
    for (int i = 0; i < 1000 && counter("far.memory_kb") > 0; ++i) tick(1);
    EXPECT_GT(counter("far.disk_kb"), 100);
    EXPECT_GT(num_away(), 70);
  }

  LocalBus bus_;
  MapperNode node_;
  Hearer hearer_{bus_};
  std::int64_t now_ = 0;
  double odometry_sent_ = -0.1;
  int turn_ = 0;
};

class FarMapOfANode : public ::testing::Test {
 protected:
  test::TemporaryFolder folder_;
  std::string far_ = folder_.path().string();
};

TEST_F(FarMapOfANode, ALateListenerGetsAllOfIt) {
  FarMap far(few_in_memory(far_)), here(few_in_memory(""));
  for (FarMap* drive : {&far, &here}) {
    drive->drive(150);
    drive->tick(50);
  }
  far.expect_on_the_disk();
  Hearer late(far.bus_);
  far.tick(60);
  EXPECT_TRUE(late.tiles.empty()) << "nobody sends the map again unasked";
  ASSERT_GT(late.announced.size(), 100U);
  far.request_all(late);
  EXPECT_EQ(late.tiles, far.hearer_.tiles);
  EXPECT_EQ(late.tiles, far.records());
  EXPECT_EQ(late.tiles, here.records()) << "where it lies makes no difference";
  EXPECT_FALSE(late.gap);
  EXPECT_GT(far.num_away(), 70) << "and stays where it is";
  EXPECT_EQ(far.counter("faults.far_tiles"), 0);
}

TEST_F(FarMapOfANode, SendsNoWrongNumbersAndSaysWhatTheDiskDoes) {
  config::MapperConfig config = few_in_memory(far_);
  config.folder = folder_ / "map";
  FarMap far(config);
  far.drive(150);
  far.tick(50);
  far.expect_on_the_disk();
  EXPECT_THAT(far.node_.report().faults, ::testing::Each(::testing::HasSubstr("LiDAR: silent"))) << "it drives no more";
  test::flip_a_bit_of_each_spilled_page();
  Hearer late(far.bus_);
  far.tick(60);
  far.request_all(late);
  EXPECT_GT(late.tiles.size(), 30U) << "what is in memory";
  EXPECT_LT(late.tiles.size(), far.hearer_.tiles.size());
  for (const auto& [key, records] : late.tiles) EXPECT_EQ(records, far.hearer_.tiles[key]);
  EXPECT_GT(far.counter("faults.far_tiles"), 70);
  EXPECT_THAT(far.node_.report().faults, ::testing::Contains(::testing::HasSubstr("a checksum is wrong")));
  far.drive(90);
  EXPECT_EQ(far.hearer_.epochs, 1);
  far.finish();
  EXPECT_EQ(far.counter("folder.saved"), 1);
  EXPECT_GT(far.counter("folder.left_out"), 70);
  EXPECT_GT(storage::load_map(config.folder).tiles.size(), 100U) << "all that there is";
}

TEST_F(FarMapOfANode, ThatIsExtendedStaysInItsFolderThoughTheDiskOfFarTilesFails) {
  config::MapperConfig config = few_in_memory(far_);
  config.folder = folder_ / "map";
  {
    FarMap first(config);
    first.drive(150);
    first.finish();
  }
  const storage::SavedMap before = storage::load_map(config.folder);
  config.mode = config::MapMode::kExtend;
  FarMap second(config);
  const auto is_found = [&] { return second.node_.mapper().fix() == tracking::Fix::kTracking; };
  for (int i = 0; i < 60 && (i < 5 || !is_found()); ++i) second.drive(1);
  ASSERT_TRUE(is_found());
  second.expect_on_the_disk();
  test::flip_a_bit_of_each_spilled_page();
  second.drive(20);
  second.finish();
  EXPECT_EQ(second.counter("folder.saved"), 1);
  const storage::SavedMap after = storage::load_map(config.folder);
  EXPECT_GT(after.tiles.size() + 60, before.tiles.size()) << "but for what the vehicle came near to";
  EXPECT_GT(second.counter("faults.far_tiles"), 0);
  EXPECT_EQ(after.epoch, second.hearer_.epoch);
  ASSERT_GE(after.nodes.size(), before.nodes.size());
  for (std::size_t i = 0; i < before.nodes.size(); ++i) EXPECT_EQ(after.nodes[i].points, before.nodes[i].points) << i;
}

TEST_F(FarMapOfANode, MovesWithAClosedLoopAndGoesOutAnew) {
  FarMap far(few_in_memory(far_)), here(few_in_memory(""));
  for (FarMap* drive : {&far, &here}) {
    drive->drive(200);
    if (drive == &far) drive->expect_on_the_disk();
    drive->drive(kOnceAround - 200);
    EXPECT_EQ(drive->counter("loops.closed"), 1);
    EXPECT_EQ(drive->hearer_.epochs, 2);
    drive->finish();
    EXPECT_FALSE(drive->hearer_.gap);
    EXPECT_EQ(drive->hearer_.tiles, drive->records());
  }
  far.expect_on_the_disk();
  EXPECT_EQ(far.records(), here.records());
  EXPECT_EQ(far.counter("faults.far_tiles"), 0);
}

TEST_F(FarMapOfANode, IsSavedOnTheWayAndAtTheEndAndLoadedBitForBit) {
  config::MapperConfig config[] = {few_in_memory(far_), few_in_memory("")};
  const std::string folders[] = {folder_ / "far", folder_ / "here"};
  for (int i = 0; i < 2; ++i) {
    config[i].folder = folders[i];
    config[i].save_every = 3;
    FarMap drive(config[i]);
    drive.drive(110);
    for (int k = 0; k < 3000 && drive.counter("folder.saved") < 1; ++k) drive.tick(1);
    ASSERT_GE(drive.counter("folder.saved"), 1);
    EXPECT_FALSE(storage::load_map(folders[i]).tiles.empty()) << "on the way";
    drive.drive(60);
    if (i == 0) drive.expect_on_the_disk();
    drive.finish();
    EXPECT_TRUE(storage::equal(storage::load_map(folders[i]), drive.node_.mapper().saved(drive.hearer_.epoch)));
    EXPECT_EQ(drive.counter("faults.folder"), 0);
  }
  EXPECT_TRUE(storage::equal(storage::load_map(folders[0]), storage::load_map(folders[1])));

  Records extended[2];
  for (int i = 0; i < 2; ++i) {
    config[i].mode = config::MapMode::kExtend;
    FarMap drive(config[i]);
    if (i == 0) {
      EXPECT_GT(drive.num_away(), 150) << "what was loaded";
    }
    drive.drive(60);
    drive.finish();
    EXPECT_EQ(drive.hearer_.tiles, drive.records());
    extended[i] = drive.records();
    EXPECT_TRUE(storage::equal(storage::load_map(folders[i]), drive.node_.mapper().saved(drive.hearer_.epoch)));
  }
  EXPECT_EQ(extended[0], extended[1]);
  EXPECT_TRUE(storage::equal(storage::load_map(folders[0]), storage::load_map(folders[1])));
}

}  // namespace
}  // namespace curbstone::mapper
