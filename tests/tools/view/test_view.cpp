#include "tools/view/view.hpp"

#include <gmock/gmock.h>

#include <curbstone/imu_t.hpp>
#include <curbstone/service_config_t.hpp>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "common/log/log_writer.hpp"
#include "common/time/clock.hpp"
#include "services/semantic_map/semantic_messages.hpp"
#include "services/semantic_map/store/map_store.hpp"
#include "tests/services/viewer/fake_connections.hpp"
#include "tests/services/viewer/frame_reader.hpp"
#include "tests/temporary_folder.hpp"
#include "tools/command/run_subcommand.hpp"
#include "tools/view/drive.hpp"
#include "tools/view/saved_map.hpp"

namespace curbstone::view {
namespace {

using semantic_map::store::MapStore;
using semantic_map::tile::CellClass;
using semantic_map::tile::MapTile;
using ::testing::HasSubstr;

constexpr std::int32_t kEpoch = 1'700'000'000;
constexpr std::int64_t kBegin = std::int64_t{kEpoch} * 1'000'000;

MapTile tile_at(std::int32_t x, CellClass kind) {
  MapTile tile;
  tile.key = {x, 0};
  tile.utime = kBegin;
  tile.cell_class.fill(kind);
  tile.height.fill(50);
  return tile;
}

/// A map of three tiles, a curb and a drive of two poses.
void write_map(const std::string& file, std::int32_t epoch) {
  MapStore store(file);
  const std::vector<semantic_map::tile::CurbLine> curbs = {
      {.id = 4, .confidence = 1, .dropped = false, .points = {{1, 1, 0, 0.12F, 0, 1}, {2, 1, 0, 0.12F, 0, 1}}}};
  MapStore::Batch batch;
  batch.epoch = epoch;
  for (int x = 0; x < 3; ++x) batch.tiles.push_back(tile_at(x, CellClass::kRoad));
  batch.trajectory = {{kBegin, 0, Pose::Identity()}, {kBegin + 50'000, 1, Pose::Identity()}};
  batch.curbs = &curbs;
  store.write(batch);
  store.close_canonical();
}

std::string bytes_of(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class SavedMapTest : public ::testing::TestWithParam<std::int64_t> {};

TEST_P(SavedMapTest, IsShownWithItsCurbsAndItsPathAndStaysAsItIs) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "map.db";
  write_map(file, static_cast<std::int32_t>((kBegin + GetParam()) / 1'000'000));
  const std::string before = bytes_of(file);
  EXPECT_TRUE(is_map_file(file));

  LocalBus bus;
  viewer::FakeConnections connections;
  viewer::ViewerNode node(viewer::ViewerConfig{}, bus, connections, {.kind = "map", .title = "map.db"});
  node.tick(kBegin);
  ShownMap(file, "map.db", node).show(kBegin);
  connections.events.push_back({1, viewer::web::Connections::Event::Kind::kConnected, "", kBegin});
  connections.events.push_back({1, viewer::web::Connections::Event::Kind::kMessage, R"({"resume": null})", kBegin});
  node.tick(kBegin + 20'000);
  ASSERT_EQ(connections.sent.size(), 1U);
  viewer::FrameReader page;
  page.read(*connections.sent[0].second);
  EXPECT_EQ(page.tiles.size(), 3U);
  EXPECT_EQ(page.tiles.at({2, 0}).cell_class[7], static_cast<std::uint8_t>(CellClass::kRoad));
  EXPECT_EQ(page.curbs.size(), 1U);
  EXPECT_GE(page.path.size(), 3U);
  EXPECT_EQ(bytes_of(file), before);
}

INSTANTIATE_TEST_SUITE_P(OfYesterdayAndOfAClockThatWasAhead, SavedMapTest,
                         ::testing::Values(-86'400'000'000, 86'400'000'000));

/// A page that looks at a map file, which changes meanwhile.
class ShownMapTest : public ::testing::Test {
 protected:
  void SetUp() override {
    write_map(file_, kEpoch);
    node_.tick(now_);
    map_.show(now_);
    send(R"({"resume": null})", viewer::web::Connections::Event::Kind::kConnected);
    send(R"({"resume": null})", viewer::web::Connections::Event::Kind::kMessage);
    look();
    ASSERT_EQ(page_.tiles.size(), 3U);
  }
  /// A second passes.
  void look() {
    map_.look(now_);
    for (int i = 0; i < 10; ++i) {
      node_.tick(now_ += 100'000);
      for (const auto& [id, frame] : std::exchange(connections_.sent, {}))
        send(R"({"ack": )" + std::to_string(page_.read(*frame)) + "}", viewer::web::Connections::Event::Kind::kMessage);
    }
  }
  std::string state() { return page_.state; }
  int begins() { return page_.begins; }

  test::TemporaryFolder folder_;
  std::string file_ = folder_ / "map.db";
  viewer::FrameReader page_;

 private:
  void send(const std::string& text, viewer::web::Connections::Event::Kind kind) {
    connections_.events.push_back({1, kind, text, now_});
  }

  LocalBus bus_;
  viewer::FakeConnections connections_;
  viewer::ViewerNode node_{viewer::ViewerConfig{}, bus_, connections_, {.kind = "map", .title = "map.db"}};
  ShownMap map_{file_, "map.db", node_};
  std::int64_t now_ = kBegin;
};

TEST_F(ShownMapTest, GrowsWithItsFile) {
  MapStore store(file_);
  MapStore::Batch batch;
  batch.epoch = kEpoch;
  batch.tiles = {tile_at(2, CellClass::kCurb), tile_at(3, CellClass::kRoad)};
  store.write(batch);  // as a mapper does while it drives
  look();
  EXPECT_EQ(page_.tiles.size(), 4U);
  EXPECT_EQ(page_.tiles.at({2, 0}).cell_class[7], static_cast<std::uint8_t>(CellClass::kCurb));
  EXPECT_EQ(page_.tiles.at({1, 0}).revision, 1) << "it is as it was";
  EXPECT_EQ(begins(), 1) << "the page keeps what it has";
}

TEST_F(ShownMapTest, GivesWayToAnotherMapOfItsName) {
  write_map(folder_ / "other.db", kEpoch);  // of the same epoch: the same log once more
  std::filesystem::rename(folder_ / "other.db", file_);
  look();
  EXPECT_EQ(begins(), 2);
  EXPECT_EQ(page_.tiles.size(), 3U);
}

TEST_F(ShownMapTest, StaysThoughItsFileIsGoneAndSaysSo) {
  std::filesystem::remove(file_);
  look();
  EXPECT_EQ(page_.tiles.size(), 3U);
  EXPECT_THAT(state(), HasSubstr("map.db (deleted)"));
  std::ofstream(file_) << "no map at all";
  look();
  EXPECT_THAT(state(), HasSubstr("map.db (cannot be read now)"));
  std::filesystem::remove(file_);
  write_map(file_, kEpoch + 5);
  look();
  EXPECT_THAT(state(), HasSubstr(R"("map.db")"));
  EXPECT_EQ(begins(), 2);
}

template <class Message>
void write(LogWriter& log, const std::string& channel, const Message& message, std::int64_t utime) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  log.write(channel, bytes.data(), static_cast<int>(bytes.size()), utime);
}

class DriveTest : public ::testing::Test {
 protected:
  /// A tile each second for ten seconds, and what no page shows.
  void record() {
    LogWriter log(file_);
    for (int i = 0; i < 10; ++i) {
      const std::int64_t utime = kBegin + i * 1'000'000;
      write(log, "SEMANTIC_TILE", semantic_map::to_message(tile_at(i, CellClass::kCurb), kEpoch, 1), utime);
      write(log, "ODOMETRY", semantic_map::to_message(tile_at(i, CellClass::kCurb), kEpoch, 1), utime);
    }
  }
  void listen() {
    shown_.subscribe<semantic_tile_t>("SEMANTIC_TILE",
                                      [this](const semantic_tile_t& m) { heard_.push_back(m.tile_x); });
    shown_.tap(
        [this](const std::string& channel, const void*, int, std::int64_t) { EXPECT_EQ(channel, "SEMANTIC_TILE"); });
  }
  /// `us` of the caller's clock, in its steps.
  void pass(Drive& drive, std::int64_t us) {
    for (const std::int64_t end = now_ + us; now_ < end; now_ += 20'000) drive.advance(now_);
    shown_.dispatch();
  }

  test::TemporaryFolder folder_;
  std::string file_ = folder_ / "drive.lcmlog";
  LocalBus shown_;
  std::vector<int> heard_;
  std::int64_t now_ = 5'000'000;
};

TEST_F(DriveTest, ShowsWhatTheServicesSaidAtThePaceOfTheDrive) {
  record();
  listen();
  Drive drive({file_}, shown_);
  EXPECT_FALSE(drive.makes_map());
  pass(drive, 2'100'000);
  EXPECT_THAT(heard_, ::testing::ElementsAre(0, 1, 2));
  drive.set_paused(true);
  pass(drive, 5'000'000);
  EXPECT_EQ(heard_.size(), 3U);
  drive.set_paused(false);
  drive.set_speed(4);
  pass(drive, 1'000'000);
  EXPECT_EQ(heard_.size(), 7U);
}

TEST_F(DriveTest, GoesToAPlaceWithAllThatWasSaidOnTheWayAlsoWhilePaused) {
  record();
  listen();
  Drive drive({file_}, shown_);
  drive.set_paused(true);
  drive.go_to(7'500'000);
  pass(drive, 500'000);
  EXPECT_EQ(heard_.size(), 8U);
  EXPECT_EQ(drive.position(), 7'500'000);
  EXPECT_TRUE(drive.player().paused());
  drive.go_to(99'000'000);
  drive.set_paused(false);
  pass(drive, 1'000'000);
  EXPECT_TRUE(drive.at_end());
  EXPECT_EQ(heard_.size(), 10U);
}

TEST_F(DriveTest, IsThatOfTheVehicleThatRecordedIt) {
  record();
  EXPECT_EQ(recorded_vehicle({file_}).length, VehicleConfig{}.length);
  LogWriter log(file_);
  write(log, "CONFIG", service_config_t{kBegin, "ekf", "ekf", "ugv", "0.0.1", "ekf:\n  vehicle:\n    length: 4.4\n"},
        kBegin);
  log.flush();
  EXPECT_EQ(recorded_vehicle({file_}).length, 4.4);
}

TEST_F(DriveTest, OfALogOfSensorsTheNodesMakeTheMap) {
  {
    LogWriter log(file_);
    imu_t message{};
    message.utime = kBegin;
    write(log, "IMU", message, kBegin);
  }
  EXPECT_TRUE(Drive({file_}, shown_).makes_map());
}

TEST_F(DriveTest, AMissingFileAndOneThatIsNoneOfOursAreOneClearLine) {
  const auto error_of = [](std::vector<std::string> arguments) {
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    ::testing::internal::CaptureStderr();
    EXPECT_EQ(command::run_subcommand("view", run_view, static_cast<int>(argv.size()), argv.data()), 1);
    return ::testing::internal::GetCapturedStderr();
  };
  EXPECT_THAT(error_of({"view", "/nowhere/map.db"}), HasSubstr("/nowhere/map.db: No such file"));
  const std::string damaged = folder_ / "map.db";
  std::ofstream(damaged) << "SQLite format 3" << std::string(4000, 'x');
  EXPECT_THAT(error_of({"view", damaged, "--set", "viewer.port=0"}), HasSubstr(damaged));
}

}  // namespace
}  // namespace curbstone::view
