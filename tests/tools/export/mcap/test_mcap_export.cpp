#include <foxglove/frames.pb.h>
#include <foxglove/log.pb.h>
#include <foxglove/packed.pb.h>
#include <foxglove/scene.pb.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <curbstone/service_config_t.hpp>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "tests/common/mcap/mcap_reader.hpp"
#include "tests/paths.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/tools/export/mcap/shown_log.hpp"
#include "tools/export/export.hpp"
#include "tools/export/mcap/lcm_schemas.hpp"

namespace curbstone::map_export {
namespace {

using curbstone::test::McapFile;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class McapExport : public ::testing::Test {
 protected:
  int run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"export", path("log"), "--out", path("out")});
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    ::testing::internal::CaptureStdout();
    ::testing::internal::CaptureStderr();
    const int status = run_export(static_cast<int>(argv.size()), argv.data());
    said_ = ::testing::internal::GetCapturedStdout() + ::testing::internal::GetCapturedStderr();
    return status;
  }
  [[nodiscard]] McapFile exported() const { return curbstone::test::read_mcap(bytes()); }
  [[nodiscard]] std::string bytes() const {
    std::ifstream in(path("out") + "/drive.mcap", std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }
  template <class Message>
  static Message last(const McapFile& file, const std::string& topic) {
    Message message;
    const auto all = file.of(topic);
    EXPECT_FALSE(all.empty()) << topic;
    EXPECT_TRUE(!all.empty() && message.ParseFromString(all.back())) << topic;
    return message;
  }

  curbstone::test::TemporaryFolder folder_;
  std::string said_;
};

TEST_F(McapExport, HoldsWhatPanelsShow) {
  curbstone::test::write_shown_log(path("log"), 12);
  ASSERT_EQ(run({"--only", "mcap"}), 0);
  const McapFile file = exported();
  EXPECT_THAT(file.errors, IsEmpty());
  EXPECT_THAT(said_, HasSubstr("drive.mcap"));
  EXPECT_EQ(file.of("/tf").size(), 240U) << "each pose";
  EXPECT_EQ(file.of("/pose").size(), 240U);
  EXPECT_NEAR(last<::foxglove::PoseInFrame>(file, "/pose").pose().position().x(), 11.95, 1e-9);
  EXPECT_EQ(last<::foxglove::FrameTransforms>(file, "/tf").transforms_size(), 4);
  EXPECT_NEAR(static_cast<double>(file.of("/map/window").size()), 24, 2);
  EXPECT_GE(file.of("/map/whole").size(), 2U);
  EXPECT_EQ(last<::foxglove::Grid>(file, "/map/whole").column_count(), 100U) << "the last state is there: 12 m";
  EXPECT_EQ(last<::foxglove::SceneUpdate>(file, "/path").entities_size(), 1);
  EXPECT_GT(last<::foxglove::SceneUpdate>(file, "/curbs").entities_size(), 0);
  EXPECT_GT(last<::foxglove::SceneUpdate>(file, "/markings").entities_size(), 0);
  EXPECT_EQ(last<::foxglove::PointCloud>(file, "/map/points").data().size(), 16U * 720);
  EXPECT_EQ(last<::foxglove::PointCloud>(file, "/lidar").frame_id(), "base_link");
  EXPECT_GT(file.of("/lidar").size(), 100U);
  EXPECT_EQ(file.of("/status/lidar").size(), 12U);
  EXPECT_EQ(nlohmann::json::parse(file.of("/status/lidar").back())["counters"]["packets"], 220);
  ASSERT_EQ(file.of("/log").size(), 3U) << "it runs, a fault begins and ends";
  ::foxglove::Log line;
  ASSERT_TRUE(line.ParseFromString(file.of("/log")[1]));
  EXPECT_EQ(line.message(), "no packets");
  EXPECT_EQ(line.level(), ::foxglove::Log::ERROR);
}

/// The commands of the vehicle, which are the names of its processes on the bus.
std::vector<std::string> processes_of_the_vehicle() {
  std::vector<std::string> names;
  std::ifstream file(test::source_path("procman/ugv.cfg"));
  for (std::string line; std::getline(file, line);) {
    const std::size_t begin = line.find("  cmd \"");
    if (begin == 0) names.push_back(line.substr(7, line.find('"', 7) - 7));
  }
  return names;
}

std::set<std::string> fields_of(const auto& message) {
  std::set<std::string> names;
  for (const auto& field : message.fields()) names.insert(field.name());
  return names;
}

TEST_F(McapExport, HoldsEachTopicAndFieldThatThePreparedLayoutNames) {
  curbstone::test::write_shown_log(path("log"), 2);
  {
    LogWriter more(path("log2"));
    for (const std::string& name : processes_of_the_vehicle()) {
      service_status_t status{};
      status.utime = curbstone::test::kLogBegin + 1'900'000;
      status.service = name;
      status.counter_name = {"dropped.queue", "dropped.kernel"};  // as common/bus/lcm_bus counts
      status.counter_value = {0, 0};
      status.num_counters = 2;
      curbstone::test::append(more, "SERVICE_STATUS", status, status.utime + 7000);
    }
  }
  std::ofstream(path("log"), std::ios::binary | std::ios::app) << std::ifstream(path("log2"), std::ios::binary).rdbuf();
  ASSERT_EQ(run({"--only", "mcap", "--without-raw"}), 0);
  const McapFile file = exported();

  const auto layout = nlohmann::json::parse(std::ifstream(test::source_path("config/foxglove/curbstone.json")));
  const auto& view = layout["configById"]["3D!curbstone"];
  std::set<std::string> frames;
  const auto tree = last<::foxglove::FrameTransforms>(file, "/tf");
  for (const auto& transform : tree.transforms()) {
    frames.insert(transform.parent_frame_id());
    frames.insert(transform.child_frame_id());
  }
  EXPECT_THAT(frames, Contains(view["followTf"].get<std::string>()));
  for (const auto& [frame, settings] : view["transforms"].items())
    EXPECT_THAT(frames, Contains(frame.substr(frame.find(':') + 1)));
  for (const auto& [topic, settings] : view["topics"].items()) {
    EXPECT_FALSE(file.of(topic).empty()) << topic;
    if (settings.contains("colorField")) {
      EXPECT_THAT(fields_of(last<::foxglove::PointCloud>(file, topic)), Contains(settings["colorField"])) << topic;
    }
    if (settings.value("colorMode", "") == "rgba-fields") {
      EXPECT_THAT(fields_of(last<::foxglove::Grid>(file, topic)),
                  ::testing::IsSupersetOf({"red", "green", "blue", "alpha"}));
    }
  }
  EXPECT_FALSE(file.of(layout["configById"]["RosOut!faults"]["topicToRender"].get<std::string>()).empty());
  int curves = 0;
  for (const auto& [id, panel] : layout["configById"].items()) {
    for (const auto& curve : panel.value("paths", nlohmann::json::array())) {
      const std::string value = curve["value"];  // /status/NAME.FIELD.FIELD
      const std::size_t dot = value.find('.');
      const auto messages = file.of(value.substr(0, dot));
      ASSERT_FALSE(messages.empty()) << value;
      std::string pointer = value.substr(dot);
      std::replace(pointer.begin(), pointer.end(), '.', '/');
      const auto message = nlohmann::json::parse(messages.back());
      EXPECT_TRUE(message.contains(nlohmann::json::json_pointer(pointer))) << value;
      ++curves;
    }
  }
  EXPECT_GE(curves, 15);
}

TEST_F(McapExport, RepeatsLinesAndPathAsAWholeForThoseWhoEnterAnywhere) {
  curbstone::test::write_shown_log(path("log"), 25);
  ASSERT_EQ(run({"--only", "mcap", "--without-raw"}), 0);
  const McapFile file = exported();
  for (const char* topic : {"/curbs", "/markings", "/path"}) {
    int wholes = 0;
    for (const std::string& bytes : file.of(topic)) {
      ::foxglove::SceneUpdate scene;
      ASSERT_TRUE(scene.ParseFromString(bytes));
      for (const auto& deletion : scene.deletions())
        wholes += deletion.type() == ::foxglove::SceneEntityDeletion::ALL ? 1 : 0;
    }
    EXPECT_GE(wholes, 3) << topic;
    EXPECT_LE(wholes, 6) << topic;
  }
}

TEST_F(McapExport, HoldsTheMessagesOfTheLogWithTheirTypes) {
  curbstone::test::write_shown_log(path("log"), 2);
  {
    LogWriter more(path("log2"));
    more.write("OURS_NOT", "0123456789abcdef", 16, curbstone::test::kLogBegin);
    more.write("SHORT", "01", 2, curbstone::test::kLogBegin);
  }
  std::ofstream(path("log"), std::ios::binary | std::ios::app) << std::ifstream(path("log2"), std::ios::binary).rdbuf();
  ASSERT_EQ(run({"--only", "mcap", "--compression", "none"}), 0);
  const McapFile file = exported();
  EXPECT_THAT(file.errors, IsEmpty());
  EXPECT_EQ(file.of("MAP_POSE").size(), 40U);
  EXPECT_THAT(file.of("OURS_NOT"), Contains("0123456789abcdef"));
  map_pose_t pose{};
  const std::string first = file.of("MAP_POSE").front();
  ASSERT_GE(pose.decode(first.data(), 0, static_cast<int>(first.size())), 0);
  EXPECT_EQ(pose.utime, curbstone::test::kLogBegin);
  for (const auto& message : file.messages) {
    const auto& channel = file.channels.at(message.channel);
    if (channel.topic != "MAP_POSE") continue;
    EXPECT_EQ(channel.encoding, "lcm");
    EXPECT_EQ(file.schemas.at(channel.schema).name, "curbstone.map_pose_t");
    EXPECT_EQ(file.schemas.at(channel.schema).encoding, "lcm");
    EXPECT_THAT(file.schemas.at(channel.schema).data, HasSubstr("struct map_pose_t {"));
    EXPECT_EQ(message.log_time - message.publish_time, 1'000'000U);
  }
  for (const auto& [id, channel] : file.channels) {
    const bool is_ours = channel.topic != "OURS_NOT" && channel.topic != "SHORT";
    EXPECT_EQ(channel.schema != 0, is_ours) << channel.topic;
  }
}

TEST_F(McapExport, HasTheLidarWhereTheRecordedVehicleHadIt) {
  const auto height = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"--only", "mcap"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_EQ(run(arguments), 0) << said_;
    const auto tree = last<::foxglove::FrameTransforms>(exported(), "/tf");
    for (const auto& transform : tree.transforms()) {
      if (transform.child_frame_id() == "lidar") return transform.translation().z();
    }
    return 0.0;
  };
  curbstone::test::write_shown_log(path("drive"), 2);
  {
    LogWriter log(path("log"));
    const service_config_t config{1,     "mapper", "mapper",
                                  "ugv", "0.0.1",  "mapper:\n  vehicle:\n    lidar: [0, 0, 0.9, 0, 0, 0]\n"};
    curbstone::test::append(log, "CONFIG", config, curbstone::test::kLogBegin);
  }
  std::ofstream(path("log"), std::ios::binary | std::ios::app)
      << std::ifstream(path("drive"), std::ios::binary).rdbuf();
  EXPECT_NEAR(height({}), 0.9, 1e-9);
  std::ofstream(path("ugv.yaml")) << "vehicle:\n  lidar: [0, 0, 1.2, 0, 0, 0]\n";
  EXPECT_NEAR(height({"--config", path("ugv.yaml")}), 1.2, 1e-9);
}

TEST_F(McapExport, IsSmallerWithoutTheLogsOwnMessages) {
  curbstone::test::write_shown_log(path("log"), 2);
  ASSERT_EQ(run({"--only", "mcap", "--without-raw"}), 0);
  EXPECT_THAT(exported().of("MAP_POSE"), IsEmpty());
  EXPECT_EQ(exported().of("/pose").size(), 40U);
}

TEST_F(McapExport, IsAFunctionOfTheLogAlone) {
  curbstone::test::write_shown_log(path("log"), 3);
  ASSERT_EQ(run({"--only", "mcap"}), 0);
  const std::string first = bytes();
  ASSERT_EQ(run({"--only", "mcap"}), 0);
  EXPECT_TRUE(first == bytes());
}

TEST_F(McapExport, OfSensorsAloneSaysHowToAddTheMap) {
  LogWriter(path("log")).write("IMU", std::array<std::uint8_t, 32>{}.data(), 32, curbstone::test::kLogBegin);
  ASSERT_EQ(run({"--only", "mcap"}), 0);
  EXPECT_THAT(said_, HasSubstr("holds no map: 'curbstone replay"));
  EXPECT_EQ(exported().of("IMU").size(), 1U);
}

TEST_F(McapExport, TakesWhateverStandsInALog) {
  {
    LogWriter log(path("log"));
    const std::string noise(300, '\xff');
    for (const char* channel :
         {"MAP_POSE", "SEMANTIC_TILE", "CURBS", "MARKINGS", "MAP_POINTS", "SERVICE_STATUS", "LIDAR_POINTS"})
      log.write(channel, noise.data(), 300, curbstone::test::kLogBegin);
    log.write("LATE", noise.data(), 300, INT64_MAX);
    log.write("EARLY", noise.data(), 300, INT64_MIN);
    log.write("", noise.data(), 0, 1);
  }
  ASSERT_EQ(run({"--only", "mcap"}), 1) << "records whose time is none are damage";
  EXPECT_THAT(exported().errors, IsEmpty());
  EXPECT_THAT(said_, HasSubstr("messages refused"));
  EXPECT_THAT(said_, HasSubstr("damaged"));
}

TEST_F(McapExport, IsMadeOfALogAndSaysSo) {
  std::ofstream(path("log")) << "no log";
  EXPECT_EQ(run({"--only", "mcap,nav2"}), 2);
  EXPECT_THAT(said_, HasSubstr("mcap is made of a log"));
  EXPECT_ANY_THROW(run({"--only", "mcap"}));
  ::testing::internal::GetCapturedStdout();
  ::testing::internal::GetCapturedStderr();
  EXPECT_TRUE(bytes().empty());
}

TEST(LcmSchemasTest, NestedTypesStandBehindTheType) {
  curb_lines_t message{};
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  const auto schema = mcap::LcmSchemas().of(bytes.data(), bytes.size());
  ASSERT_TRUE(schema);
  EXPECT_EQ(schema->name, "curbstone.curb_lines_t");
  EXPECT_LT(schema->data.find("struct curb_lines_t"), schema->data.find("struct curb_line_t"));
  EXPECT_NE(schema->data.find("struct curb_line_t"), std::string::npos);
  EXPECT_FALSE(mcap::LcmSchemas().of(bytes.data(), 3));
}

}  // namespace
}  // namespace curbstone::map_export
