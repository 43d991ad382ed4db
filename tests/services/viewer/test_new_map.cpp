// What the pages are told of a map that does not continue the one before.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "common/bus/local_bus.hpp"
#include "services/viewer/viewer_node.hpp"
#include "tests/services/viewer/fake_connections.hpp"
#include "tests/services/viewer/frame_reader.hpp"

namespace curbstone::viewer {
namespace {

constexpr std::int32_t kBefore = 1'700'000'000, kAfter = kBefore + 5;  // epochs
constexpr std::int64_t kBegan = std::int64_t{kBefore} * 1'000'000 + 10'000'000;

class NewMapTest : public ::testing::Test {
 protected:
  NewMapTest() : node_(ViewerConfig{}, bus_, connections_, {}) {
    node_.connect(bus_);
    node_.tick(now_);
    for (int i = 0; i < 4; ++i) drive(kBegan + i * 50'000, i, kBefore);
    connections_.events = {{1, web::Connections::Event::Kind::kConnected, "", now_},
                           {1, web::Connections::Event::Kind::kMessage, R"({"resume": null})", now_}};
  }
  /// The vehicle is `x` m from the map's origin at `utime`.
  void drive(std::int64_t utime, double x, std::int32_t epoch, std::int32_t revolution = 0) {
    map_pose_t pose{};
    pose.utime = utime;
    pose.revolution = revolution;
    pose.epoch = epoch;
    pose.map_base_position[0] = x;
    pose.map_base_orientation[0] = pose.map_odom_orientation[0] = 1;
    pose.flags = map_pose_t::REGISTERED;
    bus_.publish("MAP_POSE", pose);
    bus_.dispatch();
  }
  [[nodiscard]] double pose_x() const { return node_.pose()->map_base_position[0]; }
  void begin_epoch(std::int64_t utime, double x) {
    for (int i = 0; i < 3; ++i) drive(utime + i * 50'000, x, kAfter);
  }
  /// The drive of the earlier epoch is also that of the new one.
  void carry_on() {
    map_trajectory_t drive{};
    drive.epoch = kAfter;
    drive.num_pages = drive.num_poses = 1;
    drive.utimes = {kBegan};
    drive.revolutions = {1};
    drive.positions = {{-5, 0, 0}};
    drive.orientations = {{1, 0, 0, 0}};
    bus_.publish("MAP_TRAJECTORY", drive);
    bus_.dispatch();
  }
  void put_tile(int x, std::int32_t epoch) {
    semantic_tile_t tile{};
    tile.utime = kBegan;
    tile.epoch = epoch;
    tile.tile_x = x;
    tile.revision = 1;
    bus_.publish("SEMANTIC_TILE", tile);
    bus_.dispatch();
  }
  std::size_t tiles_on_the_page() {
    new_map_age();
    return page_.tiles.size();
  }
  nlohmann::json new_map_age() {
    node_.tick(now_ += 200'000);
    FrameReader& page = page_;
    for (const auto& [id, frame] : std::exchange(connections_.sent, {})) {
      const std::string number = std::to_string(page.read(*frame));
      connections_.events.push_back({id, web::Connections::Event::Kind::kMessage, R"({"ack": )" + number + "}", now_});
    }
    return nlohmann::json::parse(page.state).at("new_map_age");
  }

 private:
  LocalBus bus_;
  FakeConnections connections_;
  FrameReader page_;
  ViewerNode node_;
  std::int64_t now_ = kBegan;
};

TEST_F(NewMapTest, HasADriveThatBeginsAtItsOriginAfterTheOneBefore) {
  EXPECT_TRUE(new_map_age().is_null()) << "the first map";
  begin_epoch(kBegan + 9'000'000, 0.2);
  drive(kBegan + 12'000'000, 5, kAfter);
  EXPECT_NEAR(new_map_age().get<double>(), 3, 0.06);
}

TEST_F(NewMapTest, IsNotOneThatWasCorrectedAsAWhole) {
  begin_epoch(kBegan + 9'000'000, 0.2);
  carry_on();
  EXPECT_TRUE(new_map_age().is_null());
}

TEST_F(NewMapTest, IsNotOneWhoseDriveWasLostOnTheBus) {
  begin_epoch(kBegan + 9'000'000, 40);
  EXPECT_TRUE(new_map_age().is_null());
}

/// The owner of the tiles hears of it later than the mapper says it, or never.
TEST_F(NewMapTest, MixesNoTilesThoughOnlyTheMapperSaysIt) {
  put_tile(0, kBefore);
  EXPECT_EQ(tiles_on_the_page(), 1U);
  begin_epoch(kBegan + 9'000'000, 0.2);
  EXPECT_EQ(tiles_on_the_page(), 0U) << "those of the earlier map are gone at once";
  put_tile(1, kBefore);
  EXPECT_EQ(tiles_on_the_page(), 0U) << "and the owner's late ones are no longer taken";
  put_tile(2, kAfter);
  EXPECT_EQ(tiles_on_the_page(), 1U);
  for (int i = 0; i < 100; ++i) put_tile(i, kBefore);
  EXPECT_EQ(tiles_on_the_page(), 1U) << "however long the owner goes on";
}

TEST_F(NewMapTest, IsNotOneBecauseTheOwnerOfTheTilesSaysIt) {
  put_tile(0, kBefore);
  for (int i = 0; i < 100; ++i) put_tile(i, kAfter);
  EXPECT_EQ(tiles_on_the_page(), 1U) << "only the mapper begins one";
}

TEST_F(NewMapTest, StaysOneThoughItIsCorrectedAsAWhole) {
  begin_epoch(kBegan + 9'000'000, 0.2);
  for (int i = 0; i < 3; ++i) drive(kBegan + 20'000'000 + i * 50'000, 0.3, kAfter + 1);
  EXPECT_NEAR(new_map_age().get<double>(), 0.1, 0.2);
}

TEST_F(NewMapTest, ThePoseGoesOnWhereTheClockIsSetBack) {
  int revolution = 0;
  for (const std::int64_t back : {2'000'000LL, 3'600'000'000LL}) {
    for (int i = 1; i < 6; ++i) drive(kBegan - back + i * 50'000, 10 + i, kBefore, ++revolution);
    EXPECT_EQ(pose_x(), 15) << back;
  }
  drive(kBegan - 3'600'000'000 + 100'000, 3, kBefore, revolution - 3);
  EXPECT_EQ(pose_x(), 15) << "this one was overtaken";
}

}  // namespace
}  // namespace curbstone::viewer
