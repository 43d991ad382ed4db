#include "services/viewer/viewer_node.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "common/bus/local_bus.hpp"
#include "tests/services/viewer/fake_connections.hpp"
#include "tests/services/viewer/frame_reader.hpp"

namespace curbstone::viewer {
namespace {

using web::Connections;

constexpr std::int32_t kEpoch = 1'700'000'000;
constexpr std::int64_t kStart = std::int64_t{kEpoch} * 1'000'000 + 10'000'000;

class ViewerNodeTest : public ::testing::Test {
 protected:
  ViewerNodeTest() : node_(ViewerConfig{}, bus_, connections_, {}) {
    node_.connect(bus_);
    bus_.subscribe<tile_request_t>("TILE_REQUEST", [this](const tile_request_t& m) { requests_.push_back(m); });
    node_.tick(now_);
  }
  template <class Message>
  void receive(const std::string& channel, const Message& message) {
    bus_.publish(channel, message);
    bus_.dispatch();
  }
  void pass(double seconds) {
    for (int i = 0; i < static_cast<int>(std::lround(seconds * 50)); ++i) {
      node_.tick(now_ += 20'000);
      bus_.dispatch();
      read_frames();
    }
  }
  void send_text(const std::string& text, web::PageId page = 1) {
    connections_.events.push_back({page, Connections::Event::Kind::kMessage, text, now_});
  }
  void open() {
    connections_.events.push_back({1, Connections::Event::Kind::kConnected, "", now_});
    send_text(R"({"resume": null})");
  }
  /// The page draws whatever comes, unless it sleeps.
  void read_frames() {
    for (const auto& [id, frame] : std::exchange(connections_.sent, {})) {
      ++frames_;
      const std::uint32_t number = page_.read(*frame);
      if (!sleeps_) send_text(R"({"ack": )" + std::to_string(number) + "}", id);
    }
  }
  static semantic_tile_t tile(int x, std::int32_t revision, std::int32_t epoch = kEpoch) {
    semantic_tile_t message{};
    message.utime = kStart;
    message.epoch = epoch;
    message.tile_x = x;
    message.revision = revision;
    message.cell_class[7] = semantic_tile_t::CURB;
    return message;
  }
  static map_pose_t pose(std::int64_t utime, double x, std::int32_t epoch = kEpoch) {
    map_pose_t message{};
    message.utime = utime;
    message.epoch = epoch;
    message.map_base_position[0] = x;
    message.map_base_orientation[0] = message.map_odom_orientation[0] = 1;
    message.flags = map_pose_t::REGISTERED;
    return message;
  }
  [[nodiscard]] nlohmann::json state() const { return nlohmann::json::parse(page_.state); }
  [[nodiscard]] std::int64_t counted(const std::string& name) const { return node_.report().counters[name]; }

  LocalBus bus_;
  FakeConnections connections_;
  ViewerNode node_;
  FrameReader page_;
  std::vector<tile_request_t> requests_;
  std::int64_t now_ = kStart;
  int frames_ = 0;
  bool sleeps_ = false;
};

TEST_F(ViewerNodeTest, ShowsTilesPoseAndPathToAPage) {
  receive("SEMANTIC_TILE", tile(3, 1));
  receive("MAP_POSE", pose(kStart, 2));
  open();
  pass(0.2);
  ASSERT_EQ(page_.tiles.count({3, 0}), 1U);
  EXPECT_EQ((page_.tiles.at({3, 0}).cell_class[7]), +semantic_tile_t::CURB);
  EXPECT_EQ(page_.epoch, kEpoch);
  EXPECT_EQ(state()["pose"]["x"], 2);
  EXPECT_EQ(state()["source"], "live");
  EXPECT_EQ(page_.path.size(), 3U);
  receive("SEMANTIC_TILE", tile(4, 1));
  pass(0.2);
  EXPECT_EQ(page_.tiles.size(), 2U);
}

TEST_F(ViewerNodeTest, ForgetsAllWhenItBeginsAgainAndThePageForgetsWithIt) {
  receive("SEMANTIC_TILE", tile(3, 2));
  receive("MAP_POSE", pose(kStart, 2));
  open();
  pass(0.2);
  const double run = page_.run;
  node_.restart();
  receive("SEMANTIC_TILE", tile(4, 1));
  receive("MAP_POSE", pose(kStart - 5'000'000, 1));
  pass(0.2);
  EXPECT_NE(page_.run, run);
  EXPECT_EQ(page_.tiles.count({3, 0}), 0U);
  EXPECT_EQ(page_.tiles.count({4, 0}), 1U);
  EXPECT_EQ(state()["pose"]["x"], 1) << "an earlier pose is taken";
  EXPECT_EQ(counted("refused.nonsense"), 0);
}

TEST_F(ViewerNodeTest, OfALiveMapAPageMayOrderNothing) {
  open();
  pass(0.1);
  send_text(R"({"play": {"pause": true}})");
  pass(0.1);
  EXPECT_EQ(counted("refused.nonsense"), 1);
}

TEST(ViewerOfALogTest, TakesThePagesOrdersAndRefusesNonsense) {
  LocalBus bus;
  FakeConnections connections;
  std::vector<ViewerNode::PlaybackCommand> orders;
  ViewerNode node(ViewerConfig{}, bus, connections,
                  {.kind = "replay", .title = "", .on_order = [&](const auto& order) { orders.push_back(order); }});
  connections.events.push_back({1, Connections::Event::Kind::kConnected, "", kStart});
  for (const char* text :
       {R"({"resume": null})", R"({"play": {"pause": true, "speed": 2.5, "position": 7}})", R"({"play": {"speed": 0}})",
        R"({"play": {"position": -1}})", R"({"play": 3})", R"({"play": {"speed": "fast"}})"})
    connections.events.push_back({1, Connections::Event::Kind::kMessage, text, kStart});
  node.set_playback({.position = 4, .progress = 0.5, .speed = 1, .paused = true, .ended = false});
  node.tick(kStart);
  ASSERT_EQ(orders.size(), 2U);
  EXPECT_EQ(orders[0].pause, true);
  EXPECT_EQ(orders[0].speed, 2.5);
  EXPECT_EQ(orders[0].position, 7);
  EXPECT_FALSE(orders[1].speed) << "no number: as if it were not there";
  EXPECT_EQ(node.report().counters["refused.nonsense"], 3);
  FrameReader page;
  page.read(*connections.sent.at(0).second);
  EXPECT_EQ(nlohmann::json::parse(page.state)["playback"]["paused"], true);
}

TEST_F(ViewerNodeTest, AsksForTilesThatItMissedWhetherOrNotAPageIsOpen) {
  tile_index_t index{};
  index.utime = now_;
  index.channel = "SEMANTIC_TILE";
  index.epoch = kEpoch;
  index.num_pages = 1;
  index.num_tiles = 2;
  index.tile_x = {3, 4};
  index.tile_y = {0, 0};
  index.version = {5, 5};
  receive("SEMANTIC_TILE", tile(3, 5));
  receive("TILE_INDEX", index);
  pass(0.6);
  ASSERT_EQ(requests_.size(), 1U);
  EXPECT_EQ(requests_[0].tile_x, std::vector<std::int32_t>{4});
  EXPECT_EQ(requests_[0].channel, "SEMANTIC_TILE");
  open();
  pass(0.2);
  EXPECT_EQ(requests_.size(), 1U) << "a page asks nobody";
}

TEST_F(ViewerNodeTest, SendsTenFramesASecondAlsoWhenNothingHappens) {
  open();
  pass(2);
  EXPECT_NEAR(frames_, 20, 2);
}

TEST_F(ViewerNodeTest, APageThatSleepsGetsTwoFramesAndLaterEverything) {
  receive("SEMANTIC_TILE", tile(0, 1));
  open();
  pass(0.3);
  sleeps_ = true;
  frames_ = 0;
  for (int i = 1; i < 200; ++i) {
    receive("SEMANTIC_TILE", tile(i, 1));
    pass(0.1);
  }
  EXPECT_LE(frames_, 2);
  send_text(R"({"ack": 5})");
  for (std::uint32_t frame = 1; frame < 40; ++frame) send_text(R"({"ack": )" + std::to_string(frame) + "}");
  sleeps_ = false;
  pass(0.5);
  EXPECT_EQ(page_.tiles.size(), 200U);
}

TEST_F(ViewerNodeTest, SaysHowOldWhatItShowsIs) {
  receive("MAP_POSE", pose(kStart, 0));
  open();
  pass(0.2);
  EXPECT_LT(state()["bus_age"].get<double>(), 0.3);
  EXPECT_TRUE(state()["tile_age"].is_null());
  pass(2);
  EXPECT_GT(state()["bus_age"].get<double>(), 1.9);
  EXPECT_GT(state()["pose_age"].get<double>(), 1.9);
}

TEST_F(ViewerNodeTest, MeasuresFromTheSensorToTheDrawnFrame) {
  open();
  pass(0.2);
  semantic_tile_t message = tile(0, 1);
  message.utime = now_ - 50'000;
  receive("SEMANTIC_TILE", message);
  pass(0.3);
  EXPECT_GT(state()["latency"][0].get<double>(), 0.05);
  EXPECT_LT(state()["latency"][0].get<double>(), 0.25);
  EXPECT_GT(node_.report().latency_p99, 0.05);
}

TEST_F(ViewerNodeTest, TellsOfTheProcessesAndTheirFaults) {
  service_status_t status{};
  status.service = "mapper";
  status.fault = {"no odometry"};
  status.num_faults = 1;
  receive("SERVICE_STATUS", status);
  open();
  pass(1);
  const auto services = nlohmann::json::parse(page_.services);
  EXPECT_EQ(services[0]["name"], "mapper");
  EXPECT_EQ(services[0]["faults"][0], "no odometry");
}

TEST_F(ViewerNodeTest, DoesNotTakeItsOwnStatusForALivingBus) {
  service_status_t own{};
  own.service = "viewer";
  receive("SERVICE_STATUS", own);
  open();
  pass(1);
  EXPECT_TRUE(state()["bus_age"].is_null()) << "nothing has been heard yet";
  own.service = "lidar";
  receive("SERVICE_STATUS", own);
  pass(0.3);
  EXPECT_LT(state()["bus_age"].get<double>(), 0.5);
}

lidar_points_t one_point(int packet, std::int64_t utime) {
  lidar_points_t points{};
  points.utime = utime;
  points.packet = points.revolution = packet;
  points.num_points = 1;
  points.x = points.y = points.z = points.time_offset = {1};
  points.intensity = points.ring = {1};
  return points;
}

TEST_F(ViewerNodeTest, TakesTheLidarsPointsOnlyWhileAPageShowsThem) {
  open();
  pass(0.2);
  for (const int i : {1, 2}) receive("LIDAR_POINTS", one_point(i, kStart + i * 50'000));
  pass(0.2);
  EXPECT_EQ(page_.num_points, 0U);
  send_text(R"({"points": true})");
  pass(0.2);
  for (const int i : {3, 4}) receive("LIDAR_POINTS", one_point(i, kStart + i * 50'000));
  pass(0.2);
  EXPECT_EQ(page_.num_points, 1U);
}

TEST_F(ViewerNodeTest, OfTwoLidarsOnOneChannelThePageShowsOne) {
  open();
  send_text(R"({"points": true})");
  pass(0.2);
  for (int i = 0; i < 40; ++i) {
    receive("LIDAR_POINTS", one_point(1000 + i, kStart + 1333 * i));
    receive("LIDAR_POINTS", one_point(i, kStart - 3'600'000'000 + 1333 * i));
  }
  EXPECT_EQ(counted("refused.second_lidar"), 40);
}

TEST_F(ViewerNodeTest, ANewEpochOfTheMapperBeginsAnew) {
  receive("SEMANTIC_TILE", tile(3, 1));
  receive("MAP_POSE", pose(kStart, 0));
  open();
  pass(0.2);
  map_trajectory_t drive{};
  drive.epoch = kEpoch + 5;
  drive.num_pages = 1;
  drive.num_poses = 2;
  drive.utimes = {kStart - 20, kStart - 10};
  drive.revolutions = {1, 2};
  drive.positions = {{1, 0, 0}, {2, 0, 0}};
  drive.orientations = {{1, 0, 0, 0}, {1, 0, 0, 0}};
  receive("MAP_TRAJECTORY", drive);
  EXPECT_EQ(page_.tiles.size(), 1U) << "one message begins nothing";
  receive("MAP_POSE", pose(kStart + 50'000, 3, kEpoch + 5));
  pass(0.2);
  EXPECT_EQ(page_.epoch, kEpoch + 5);
  EXPECT_EQ(page_.tiles.size(), 0U);
  EXPECT_EQ(page_.path.size(), 9U) << "the drive as the new epoch has it, and the pose";
}

TEST_F(ViewerNodeTest, BadMessagesAreCounted) {
  semantic_tile_t bad = tile(3, 1);
  bad.cell_class[0] = 77;
  receive("SEMANTIC_TILE", bad);
  EXPECT_EQ(counted("refused.tile"), 1);
  map_pose_t nowhere = pose(kStart, NAN);
  receive("MAP_POSE", nowhere);
  EXPECT_EQ(counted("refused.pose"), 1);
  curb_lines_t curbs{};
  curbs.epoch = kEpoch;
  curbs.box_min[0] = NAN;
  receive("CURBS", curbs);
  EXPECT_EQ(counted("refused.curbs"), 1);
  marking_lines_t markings{};
  markings.epoch = kEpoch;
  markings.num_lines = 1;
  markings.lines.resize(1);
  markings.lines[0].width = NAN;
  receive("MARKINGS", markings);
  EXPECT_EQ(counted("refused.markings"), 1);
}

TEST_F(ViewerNodeTest, WhateverAPageSaysNothingBreaks) {
  open();
  pass(0.1);
  const std::vector<std::string> talk = {"",
                                         "x",
                                         "{",
                                         "[]",
                                         "null",
                                         "7",
                                         R"({"ack": -1})",
                                         R"({"ack": 1e300})",
                                         R"({"ack": "1"})",
                                         R"({"ack": 4000000000})",
                                         R"({"points": 3})",
                                         R"({"other": 1})",
                                         R"({"resume": {"run": "x", "epoch": 1e99, "number": -5}})",
                                         "\xff\xfe",
                                         std::string(4000, '[')};
  for (const std::string& text : talk) send_text(text);
  send_text(R"({"ack": 1})", 99);
  pass(0.3);
  EXPECT_GE(counted("refused.nonsense"), 12);
  EXPECT_GT(frames_, 0);
  connections_.events.push_back({1, Connections::Event::Kind::kDisconnected, "", now_});
  pass(0.1);
  EXPECT_EQ(counted("pages"), 0);
}

}  // namespace
}  // namespace curbstone::viewer
