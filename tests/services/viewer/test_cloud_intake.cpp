#include "services/viewer/cloud_intake.hpp"

#include <gtest/gtest.h>

#include <curbstone/tile_request_t.hpp>

#include "common/bus/local_bus.hpp"
#include "services/viewer/viewer_node.hpp"
#include "tests/services/viewer/cloud_messages.hpp"
#include "tests/services/viewer/fake_connections.hpp"
#include "tests/services/viewer/frame_reader.hpp"

namespace curbstone::viewer {
namespace {

class CloudIntakeTest : public ::testing::Test {
 protected:
  CloudIntakeTest() {
    bus_.subscribe<tile_request_t>("TILE_REQUEST", [this](const tile_request_t& m) { requests_.push_back(m); });
    pose_.emplace();
  }
  void pass(double seconds) {
    for (int i = 0; i < static_cast<int>(seconds * 50); ++i) {
      intake_.tick(now_ += 20'000, wish_, epoch_, pose_, &bus_, bus_);
      bus_.dispatch();
    }
  }
  template <class Message>
  void receive(const std::string& channel, const Message& message) {
    bus_.publish(channel, message);
    bus_.dispatch();
  }
  [[nodiscard]] tile_index_t index(const std::string& channel, std::initializer_list<int> x, int version) const {
    tile_index_t message{};
    message.utime = now_;
    message.channel = channel;
    message.epoch = epoch_;
    message.num_pages = 1;
    message.num_tiles = static_cast<std::int32_t>(x.size());
    message.tile_x = x;
    message.tile_y.assign(x.size(), 0);
    message.version.assign(x.size(), version);
    return message;
  }
  [[nodiscard]] std::size_t tiles() const { return intake_.cloud().tiles().size(); }

  LocalBus bus_;
  CloudIntake intake_{"viewer:test"};
  CloudIntake::Wish wish_;
  std::optional<map_pose_t> pose_;
  std::int32_t epoch_ = 3;
  std::int64_t now_ = 1'000'000'000;
  std::vector<tile_request_t> requests_;
};

TEST_F(CloudIntakeTest, TakesNothingUnlessAPageAsks) {
  pass(0.1);
  receive("MAP_POINTS", records({0, 0}, 0, 10));
  intake_.on(index("MAP_POINTS", {0}, 10));
  pass(1);
  EXPECT_EQ(tiles(), 0U);
  EXPECT_TRUE(requests_.empty());
  wish_.add({.wide = true});
  pass(0.1);
  receive("MAP_POINTS", records({0, 0}, 0, 10));
  receive("MAP_POINTS", records({30, 0}, 0, 10));
  EXPECT_EQ(tiles(), 1U);
  wish_ = {};
  pass(0.1);
  EXPECT_EQ(tiles(), 0U);
  receive("MAP_POINTS", records({0, 0}, 10, 10));
  EXPECT_EQ(tiles(), 0U);
}

TEST_F(CloudIntakeTest, AsksForNearTilesThatWereMappedBeforeAFewAtATime) {
  wish_.add({.wide = true});
  pass(0.1);
  intake_.on(index("MAP_POINTS", {-3, -2, -1, 0, 1, 2, 30}, 10));
  pass(0.5);
  ASSERT_FALSE(requests_.empty());
  EXPECT_EQ(requests_[0].channel, "MAP_POINTS");
  EXPECT_EQ(requests_[0].tile_x.size(), CloudIntake::kRequested);
  EXPECT_TRUE(requests_[0].tile_x[0] == 0 || requests_[0].tile_x[0] == -1);
  for (const int x : {-3, -2, -1, 0, 1, 2}) receive("MAP_POINTS", records({x, 0}, 0, 10));
  pass(1);
  requests_.clear();
  pass(2);
  EXPECT_TRUE(requests_.empty());
  receive("MAP_POINTS", records({0, 0}, 15, 10));  // a message was lost
  pass(0.5);
  ASSERT_EQ(requests_.size(), 1U);
  EXPECT_EQ(requests_[0].tile_x, std::vector<std::int32_t>{0});
  EXPECT_EQ(requests_[0].have, std::vector<std::int32_t>{10});
}

TEST_F(CloudIntakeTest, ACrossSectionAsksForItsTilesWhereverItIs) {
  wish_.add({.cut = std::pair{300.5, 1.5}});
  pass(0.3);
  ASSERT_FALSE(requests_.empty());
  EXPECT_NE(std::find(requests_[0].tile_x.begin(), requests_[0].tile_x.end(), 100), requests_[0].tile_x.end());
  receive("MAP_POINTS", records({100, 0}, 0, 10));
  receive("MAP_POINTS", records({0, 0}, 0, 10));
  EXPECT_EQ(tiles(), 1U);
  wish_ = {};
  wish_.add({.cut = std::pair{1e300, -1e300}});
  pass(0.5);
  EXPECT_EQ(tiles(), 0U);
}

TEST_F(CloudIntakeTest, SaliencyIsOfTheVotersAndPointsShowWithoutIt) {
  wish_.add({.wide = true, .saliency = true});
  pass(0.1);
  receive("MAP_POINTS", records({0, 0}, 0, 10));
  EXPECT_EQ((intake_.cloud().tiles().at({0, 0}).slots[0].point.surface), 0);
  receive("VOTED_POINTS", voted({0, 0}, 0, 10, 0, 1));
  EXPECT_EQ((intake_.cloud().tiles().at({0, 0}).slots[0].point.surface), 100);
  intake_.on(index("VOTED_POINTS", {0, 1}, 1));
  intake_.on(index("MAP_POINTS", {0, 1}, 10));
  pass(0.5);
  ASSERT_EQ(requests_.size(), 1U);
  EXPECT_EQ(requests_[0].channel, "VOTED_POINTS");
  EXPECT_EQ(requests_[0].tile_x, std::vector<std::int32_t>{1});
  wish_ = {};
  wish_.add({.wide = true});
  pass(0.1);
  receive("VOTED_POINTS", voted({0, 0}, 0, 10, 0, 2));
  EXPECT_EQ(tiles(), 0U);
}

TEST_F(CloudIntakeTest, HearsAChannelOnlyWhileItIsWantedAndSomeSecondsLonger) {
  pass(0.1);
  EXPECT_FALSE(bus_.hears("MAP_POINTS") || bus_.hears("VOTED_POINTS"));
  wish_.add({.wide = true, .saliency = true});
  pass(0.1);
  EXPECT_TRUE(bus_.hears("MAP_POINTS") && bus_.hears("VOTED_POINTS"));
  wish_ = {};
  wish_.add({.wide = true});
  pass(4);
  EXPECT_TRUE(bus_.hears("VOTED_POINTS")) << "the page may come back";
  pass(2);
  EXPECT_FALSE(bus_.hears("VOTED_POINTS"));
  EXPECT_TRUE(bus_.hears("MAP_POINTS"));
  wish_ = {};
  pass(6);
  EXPECT_FALSE(bus_.hears("MAP_POINTS"));
  wish_.add({.wide = true, .saliency = true});
  pass(0.1);
  receive("VOTED_POINTS", voted({0, 0}, 0, 10, 0, 1));
  EXPECT_EQ(tiles(), 1U) << "and can be wanted again";
}

TEST_F(CloudIntakeTest, ANewEpochEmptiesIt) {
  wish_.add({.wide = true});
  pass(0.1);
  receive("MAP_POINTS", records({0, 0}, 0, 10));
  epoch_ = 4;
  pass(0.1);
  EXPECT_EQ(tiles(), 0U);
  receive("MAP_POINTS", records({0, 0}, 0, 10, 4));
  EXPECT_EQ(tiles(), 1U);
}

TEST_F(CloudIntakeTest, BadMessagesAreCounted) {
  wish_.add({.wide = true, .saliency = true});
  pass(0.1);
  map_points_t points = records({0, 0}, 0, 3);
  points.x[0] = 1500;
  receive("MAP_POINTS", points);
  voted_points_t step = voted({0, 0}, 0, 3, 0, 1);
  step.voter[0] = 9;
  receive("VOTED_POINTS", step);
  EXPECT_EQ(intake_.counters()["refused.map_points"], 1);
  EXPECT_EQ(intake_.counters()["refused.voted_points"], 1);
}

TEST(ViewerWithACloud, SendsItToThePageThatAsks) {
  LocalBus bus;
  FakeConnections connections;
  ViewerNode node(ViewerConfig{}, bus, connections, {});
  node.connect(bus);
  std::int64_t now = 1'700'000'000'000'000;
  FrameReader page;
  const auto say = [&](const std::string& text) {
    connections.events.push_back({1, web::Connections::Event::Kind::kMessage, text, now});
  };
  const auto pass = [&] {
    for (int i = 0; i < 10; ++i) {
      node.tick(now += 20'000);
      bus.dispatch();
      for (const auto& [id, frame] : std::exchange(connections.sent, {}))
        say(R"({"ack": )" + std::to_string(page.read(*frame)) + "}");
    }
  };
  node.tick(now);
  map_pose_t pose{};
  pose.utime = now;
  pose.epoch = 3;
  pose.map_base_orientation[0] = pose.map_odom_orientation[0] = 1;
  bus.publish("MAP_POSE", pose);
  connections.events.push_back({1, web::Connections::Event::Kind::kConnected, "", now});
  say(R"({"resume": null})");
  pass();
  bus.publish("MAP_POINTS", records({0, 0}, 0, 10));
  pass();
  EXPECT_TRUE(page.cloud.empty());
  say(R"({"cloud": {"wide": true}})");
  pass();
  bus.publish("MAP_POINTS", records({0, 0}, 0, 10));
  pass();
  EXPECT_EQ(page.cloud.size(), 1U);
  map_points_t bad = records({0, 0}, 10, 1);
  bad.y[0] = -1;
  bus.publish("MAP_POINTS", bad);
  bus.dispatch();
  EXPECT_EQ(node.report().counters["refused.map_points"], 1);
}

}  // namespace
}  // namespace curbstone::viewer
