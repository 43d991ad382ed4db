#include "services/viewer/foxglove/endpoint.hpp"

#include <foxglove/frames.pb.h>
#include <foxglove/scene.pb.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/services/viewer/fake_connections.hpp"
#include "tests/services/viewer/tiles.hpp"

namespace curbstone::viewer::foxglove {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

curb_lines_t curb_at(float x) {
  curb_line_t line{};
  line.num_points = 2;
  line.x = {x, x + 1};
  line.y = line.z = line.height = line.high_side_x = line.high_side_y = {0, 0};
  curb_lines_t message{};
  message.box_min[0] = x - 5;
  message.box_max[0] = x + 5;
  message.box_min[1] = -5;
  message.box_max[1] = 5;
  message.lines = {line};
  message.num_lines = 1;
  return message;
}

/// A small world that a test changes, and a client of an endpoint.
class EndpointTest : public ::testing::Test {
 protected:
  EndpointTest() {
    map_pose_t pose{};
    pose.utime = 5;
    pose.map_base_position[0] = 10;
    pose.map_base_orientation[0] = pose.map_odom_orientation[0] = 1;
    pose.map_odom_position[1] = 2;
    pose_ = pose;
    map_.put({1, 1}, draw_cells(random_, 1));
    path_.put({1, 0, 0, 0});
    events(web::Connections::Event::Kind::kConnected);
    tick(0);
  }
  void events(web::Connections::Event::Kind kind, const std::string& text = "") {
    connections_.events.push_back({1, kind, text, 0});
  }
  void send_text(const std::string& text) { events(web::Connections::Event::Kind::kMessage, text); }
  void subscribe(std::uint32_t id, std::uint32_t channel) {
    send_text(json({{"op", "subscribe"}, {"subscriptions", {{{"id", id}, {"channelId", channel}}}}}).dump());
  }
  void tick(double seconds) {
    steps_.close(map_);
    const World world{.map = {.run = 1,
                              .epoch = 1,
                              .map = map_,
                              .steps = steps_,
                              .curbs = curbs_,
                              .markings = markings_,
                              .path = path_,
                              .scan = scan_,
                              .scan_number = scan_number_,
                              .services = "",
                              .services_number = 0,
                              .newest_utime = 3},
                      .pose = pose_,
                      .vehicle = vehicle_,
                      .status = status_,
                      .points = points_};
    endpoint_.tick(world, kBegin + static_cast<std::int64_t>(seconds * 1e6));
  }
  /// Ids of the subscriptions that were served since the last call.
  std::vector<int> served() {
    std::vector<int> ids;
    for (const auto& [page, frame] : connections_.sent) {
      EXPECT_EQ(frame->at(0), 1);
      ids.push_back(frame->at(1));
    }
    last_ = connections_.sent.empty()
                ? ""
                : std::string(connections_.sent.back().second->begin() + 13, connections_.sent.back().second->end());
    connections_.sent.clear();
    return ids;
  }
  std::vector<std::string> received() {
    std::vector<std::string> ops;
    for (const auto& [page, text] : connections_.texts) ops.push_back(json::parse(text)["op"]);
    last_text_ = connections_.texts.empty() ? "" : connections_.texts.back().second;
    connections_.texts.clear();
    return ops;
  }

  static constexpr std::int64_t kBegin = 1'700'000'000'000'000;
  std::mt19937 random_{1};
  FakeConnections connections_;
  store::LiveMap map_;
  frames::TileSteps steps_;
  store::CurbLines curbs_;
  store::MarkingLines markings_;
  store::ThinnedPath path_;
  std::vector<frames::ScanPoint> scan_;
  std::uint64_t scan_number_ = 0;
  std::optional<map_pose_t> pose_;
  VehicleConfig vehicle_;
  StatusHistory status_;
  NearPoints points_;
  Endpoint endpoint_{connections_, "17"};
  std::string last_;
  std::string last_text_;
};

TEST_F(EndpointTest, TellsAClientWhatThereIs) {
  EXPECT_THAT(received(), ElementsAre("serverInfo", "advertise"));
  const json channels = json::parse(last_text_)["channels"];
  ASSERT_EQ(channels.size(), 10U);
  EXPECT_EQ(channels[2]["topic"], "/map/window");
  EXPECT_EQ(channels[2]["schemaName"], "foxglove.Grid");
  EXPECT_GT(channels[2]["schema"].get<std::string>().size(), 500U);
  EXPECT_TRUE(served().empty()) << "nothing goes unasked";
}

TEST_F(EndpointTest, TellsOfAProcessThatIsHeardLater) {
  received();
  service_status_t message{};
  message.service = "lidar";
  status_.put(message);
  tick(1);
  EXPECT_THAT(received(), ElementsAre("advertise"));
  EXPECT_EQ(json::parse(last_text_)["channels"][0]["topic"], "/status/lidar");
  subscribe(8, kFirstStatus);
  tick(2);
  EXPECT_THAT(served(), ElementsAre(8));
  EXPECT_THAT(last_, HasSubstr("\"counters\""));
  tick(3);
  EXPECT_TRUE(served().empty());
}

TEST_F(EndpointTest, SendsTheStateOnSubscribingAndThenWhatChanges) {
  subscribe(21, kTransforms);
  tick(1);
  EXPECT_THAT(served(), ElementsAre(21));
  ::foxglove::FrameTransforms transforms;
  ASSERT_TRUE(transforms.ParseFromString(last_));
  ASSERT_EQ(transforms.transforms_size(), 4);
  EXPECT_EQ(transforms.transforms(0).child_frame_id(), "odom");
  EXPECT_EQ(transforms.transforms(1).parent_frame_id(), "odom");
  EXPECT_DOUBLE_EQ(transforms.transforms(1).translation().x(), 10);
  EXPECT_DOUBLE_EQ(transforms.transforms(1).translation().y(), -2);
  EXPECT_DOUBLE_EQ(transforms.transforms(2).translation().z(), 1.73);
  tick(2);
  EXPECT_TRUE(served().empty());
  pose_->utime = 6;
  tick(2.02);
  EXPECT_THAT(served(), ElementsAre(21));
  subscribe(22, kTransforms);
  tick(3);
  EXPECT_THAT(served(), ElementsAre(22)) << "again, as it asked again";
}

TEST_F(EndpointTest, SendsTheWindowTwiceASecondAndTheWholeMapEachTenSecondsIfTheyChange) {
  subscribe(1, kMapWindow);
  subscribe(2, kMapWhole);
  std::vector<int> windows;
  int wholes = 0;
  for (int k = 0; k < 1000; ++k) {  // 20 s
    map_.put({k % 3, 0}, draw_cells(random_, k + 1));
    tick(1 + 0.02 * k);
    for (const int id : served()) {
      if (id == 1) windows.push_back(k);
      if (id == 2) ++wholes;
    }
  }
  EXPECT_EQ(wholes, 2);
  EXPECT_GE(windows.size(), 38U);
  EXPECT_LE(windows.size(), 40U);
  for (int k = 0; k < 1000; ++k) tick(21 + 0.02 * k);
  EXPECT_LE(served().size(), 2U) << "nothing changes, nothing goes";
}

TEST_F(EndpointTest, SendsCurbsAsAWholeOnceAndThenTheNewOnes) {
  curbs_.put(curb_at(50));
  subscribe(5, kCurbs);
  tick(1);
  EXPECT_THAT(served(), ElementsAre(5));
  curbs_.put(curb_at(0));
  tick(1.1);
  EXPECT_TRUE(served().empty()) << "twice a second at most";
  tick(1.6);
  EXPECT_THAT(served(), ElementsAre(5));
  ::foxglove::SceneUpdate scene;
  ASSERT_TRUE(scene.ParseFromString(last_));
  EXPECT_EQ(scene.entities_size(), 1);
  EXPECT_EQ(scene.deletions_size(), 0);
}

TEST_F(EndpointTest, SendsNothingLargeToAClientThatIsSlowAndNothingAtAllToOneThatStopped) {
  subscribe(1, kMapWindow);
  subscribe(2, kPose);
  connections_.waiting = Endpoint::kMaxQueuedForLarge + 1;
  tick(1);
  EXPECT_THAT(served(), ElementsAre(2));
  connections_.waiting = Endpoint::kMaxQueued + 1;
  pose_->utime = 6;
  tick(2);
  EXPECT_TRUE(served().empty());
  connections_.waiting = 0;
  pose_->utime = 7;
  tick(3);
  EXPECT_THAT(served(), ElementsAre(2, 1)) << "the newest of each, and not what was missed";
}

TEST_F(EndpointTest, SendsNoMoreThanSoMuchASecondToAClientThatSubscribesAgainAndAgain) {
  std::size_t bytes = 0;
  for (int k = 0; k < 500; ++k) {  // 10 s
    subscribe(1, kMapWindow);
    tick(1 + 0.02 * k);
    for (const auto& [page, frame] : connections_.sent) bytes += frame->size();
    connections_.sent.clear();
  }
  EXPECT_LE(bytes, 11 * Endpoint::kMaxPerSecond);
  EXPECT_GT(bytes, 5 * Endpoint::kMaxPerSecond);
}

TEST_F(EndpointTest, StopsWhenToldTo) {
  subscribe(2, kPose);
  tick(1);
  EXPECT_TRUE(endpoint_.wants(kPose));
  send_text(R"({"op":"unsubscribe","subscriptionIds":[2,77]})");
  pose_->utime = 6;
  tick(2);
  EXPECT_THAT(served(), ElementsAre(2));
  EXPECT_FALSE(endpoint_.wants(kPose));
}

TEST_F(EndpointTest, AnswersNonsenseWithAWordAndGoesOn) {
  received();
  for (const char* text :
       {"hello", R"({"op":"setParameters"})", R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":77}]})"})
    send_text(text);
  send_text(json({{"op", "subscribe"}, {"subscriptions", {{{"id", 1}, {"channelId", kFirstStatus}}}}}).dump());
  tick(1);
  EXPECT_THAT(received(), ElementsAre("status", "status", "status", "status"));
  EXPECT_EQ(endpoint_.counters()["refused.foxglove"], 4);
  subscribe(2, kPose);
  tick(2);
  EXPECT_THAT(served(), ElementsAre(2));
  events(web::Connections::Event::Kind::kDisconnected);
  tick(3);
  EXPECT_EQ(endpoint_.counters()["foxglove.clients"], 0);
}

}  // namespace
}  // namespace curbstone::viewer::foxglove
