#include <gtest/gtest.h>

#include <atomic>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/bus/local_bus.hpp"
#include "common/log/log_reader.hpp"
#include "common/time/clock.hpp"
#include "services/viewer/foxglove_node.hpp"
#include "services/viewer/viewer_node.hpp"
#include "services/viewer/web/web_server.hpp"
#include "tests/foxglove/readers.hpp"
#include "tests/services/viewer/fake_connections.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/tools/export/mcap/shown_log.hpp"
#include "tools/export/export.hpp"

namespace curbstone {
namespace {

using nlohmann::json;

/// A log of 12 s, of which all products are in it.
class FoxgloveReaders : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto packages = test::foxglove_packages();
    if (!packages) GTEST_SKIP() << "needs node, npm (scripts/install-deps --readers), and once its registry";
    node_ = "cd " + *packages + " && node ";
    test::write_shown_log(path("log"), 12);
  }
  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }

  test::TemporaryFolder folder_;
  std::string node_;
};

TEST_F(FoxgloveReaders, ReadTheMcapFileByItsIndexAndFindThePublishedSchemas) {
  for (const std::string compression : {"zstd", "none"}) {
    std::vector<std::string> words = {"export", path("log"), "--only",        "mcap",
                                      "--out",  path("out"), "--compression", compression};
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    ASSERT_EQ(map_export::run_export(static_cast<int>(argv.size()), argv.data()), 0);
    const json said = json::parse(test::output_of(node_ + "read_mcap.mjs " + path("out") + "/drive.mcap"));
    EXPECT_EQ(said["wrong"], json::array());
    const json& topics = said["topics"];
    EXPECT_EQ(topics["/tf"]["count"], 240);
    EXPECT_EQ(topics["/tf"]["last"]["transforms"].size(), 4U);
    EXPECT_NEAR(topics["/pose"]["last"]["pose"]["position"]["x"].get<double>(), 11.95, 1e-9);
    EXPECT_EQ(topics["/map/whole"]["last"]["column_count"], 100);
    EXPECT_EQ(topics["/map/whole"]["last"]["data"]["bytes"], 100 * 25 * 12);
    EXPECT_EQ(topics["/map/whole"]["schema"], "foxglove.Grid");
    EXPECT_EQ(topics["/map/points"]["last"]["data"]["bytes"], 720 * 16);
    EXPECT_EQ(topics["/curbs"]["schema"], "foxglove.SceneUpdate");
    EXPECT_EQ(topics["/markings"]["schema"], "foxglove.SceneUpdate");
    const json& paint = topics["/markings"]["last"]["entities"][0];
    EXPECT_EQ(paint["metadata"][0]["value"], "solid line");
    EXPECT_EQ(paint["triangles"][0]["points"].size(), 4U);
    EXPECT_EQ(paint["triangles"][0]["indices"].size(), 6U);
    EXPECT_EQ(topics["/log"]["last"]["message"], "no longer: no packets");
    EXPECT_EQ(topics["/status/lidar"]["last"]["counters"]["packets"], 220);
    EXPECT_EQ(topics["MAP_POSE"]["schema"], "curbstone.map_pose_t");
    EXPECT_EQ(topics["MAP_POSE"]["count"], 240);
  }
}

/// The log's drive on a bus, with the endpoint open, until the client has seen what it wants.
TEST_F(FoxgloveReaders, ComeInThroughTheDoorByBothNamesOfTheProtocol) {
  viewer::ViewerConfig config;
  viewer::FakeConnections pages;
  LocalBus bus;
  viewer::ViewerNode node(config, bus, pages, {.kind = "live", .title = ""});
  viewer::web::WebServer server(viewer::endpoint_settings(config));
  viewer::FoxgloveNode endpoint(config, node, server, "17");
  node.connect(bus);
  endpoint.connect(bus);
  const auto play = [&] {
    LogReader log(path("log"));
    while (const auto event = log.next()) {
      node.tick(event->log_utime);
      endpoint.tick(event->log_utime);
      bus.inject(event->channel, event->bytes.data(), static_cast<int>(event->bytes.size()));
      bus.dispatch();
    }
  };
  play();
  for (const std::string subprotocol : {"foxglove.sdk.v1", "foxglove.websocket.v1"}) {
    std::atomic<bool> is_over = false;
    std::string output;
    std::thread client([&] {
      output = test::output_of(
          node_ + "talk.mjs ws://127.0.0.1:" + std::to_string(server.port()) + " " + subprotocol +
          " /tf /pose /map/window /map/whole /curbs /markings /path /lidar /map/points /log /status/lidar");
      is_over = true;
    });
    while (!is_over) {
      play();  // the scan and the points come once they are asked for
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    client.join();
    const json said = json::parse(output);
    EXPECT_EQ(said["wrong"], json::array());
    EXPECT_EQ(said["statuses"], json::array());
    EXPECT_EQ(said["protocol"], subprotocol);
    EXPECT_EQ(said["serverInfo"]["capabilities"], json::array());
    EXPECT_EQ(said["topics"]["/map/window"]["last"]["column_count"], 500);
    EXPECT_EQ(said["topics"]["/map/window"]["last"]["data"]["bytes"], 500 * 500 * 12);
    EXPECT_EQ(said["topics"]["/markings"]["last"]["entities"].size(), 1U);
    EXPECT_EQ(said["topics"]["/tf"]["seconds"].get<std::int64_t>() / 100, 17'000'000);
    EXPECT_EQ(said["topics"]["/status/lidar"]["last"]["counters"].size(), 1U);
  }
}

}  // namespace
}  // namespace curbstone
