#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <curbstone/imu_t.hpp>
#include <curbstone/service_config_t.hpp>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "common/bus/local_bus.hpp"
#include "common/log/log_reader.hpp"
#include "services/recorder/recorder_node.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::recorder {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr std::int64_t kSessionStart = 1'795'467'120'000'000;  // 2026-11-23T20:52:00Z, us

class SessionTest : public ::testing::Test {
 protected:
  SessionTest() {
    config_.folder = (folder_ / "log").string();
    config_.keep_free = 0;
  }

  void send_config(const std::string& service, const std::string& yaml) {
    service_config_t message;
    message.utime = kSessionStart;
    message.service = service;
    message.section = service.substr(0, service.find(':'));
    message.host = "ugv";
    message.version = "1.2.3";
    message.yaml = yaml;
    bus_.publish("CONFIG", message);
  }
  static std::vector<std::string> channels(const fs::path& log) {
    LogReader reader(log.string());
    std::vector<std::string> channels;
    while (const auto event = reader.next()) channels.push_back(event->channel);
    return channels;
  }
  static std::string text(const fs::path& file) {
    std::ifstream in(file);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  /// A session of that day with a log in it.
  [[nodiscard]] fs::path old_session(int day) const {
    const fs::path path = folder_ / "log" / ("2026-01-0" + std::to_string(day) + "T100000Z");
    fs::create_directories(path);
    std::ofstream(path / "drive-000.lcmlog") << "log";
    std::ofstream(path / "config.yaml") << "";
    return path;
  }
  /// Free bytes as if each session that is there took one GB of ten.
  static std::int64_t ten_gb_less_sessions(const fs::path& folder) {
    return 10'000'000'000 - 1'000'000'000 * std::distance(fs::directory_iterator(folder), fs::directory_iterator());
  }

  test::TemporaryFolder folder_;
  RecorderConfig config_;
  LocalBus bus_;
};

TEST_F(SessionTest, IsAFolderNamedByItsStartInUtc) {
  const fs::path session = folder_ / "log" / "2026-11-23T205200Z";
  {
    RecorderNode node(config_, bus_, kSessionStart);
    bus_.publish("IMU", imu_t{});
    send_config("ekf", "ekf:\n  a: 1\n");
    node.finish();
    EXPECT_THAT(channels(session / "drive-000.lcmlog"), ElementsAre("IMU", "CONFIG"));
  }
  EXPECT_THAT(text(session / "config.yaml"), HasSubstr("# ekf on ugv, version 1.2.3\nekf:\n  a: 1\n"));
  {
    RecorderNode node(config_, bus_, kSessionStart);
    bus_.publish("IMU", imu_t{});
  }
  EXPECT_TRUE(fs::exists(session.string() + "-2/drive-000.lcmlog")) << "another one of the same second";
}

TEST_F(SessionTest, EachFileBeginsWithTheConfigurationThatIsKnown) {
  Session session(config_.folder, kSessionStart);
  ConfigCache memory;
  service_config_t message;
  message.service = message.section = "mapper";
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  EXPECT_TRUE(memory.take(bytes.data(), static_cast<int>(bytes.size())));
  EXPECT_FALSE(memory.take(bytes.data(), static_cast<int>(bytes.size()))) << "nothing new";
  EXPECT_FALSE(memory.take(bytes.data(), 11)) << "no CONFIG";
  {
    Recording recording([&] { return session.next_log(); }, 1,
                        [&](LogWriter& log, std::int64_t utime) { memory.write(log, utime); });
    const int number = 7;
    for (std::int64_t i = 0; i < 3; ++i) recording.write("IMU", &number, sizeof number, kSessionStart + i);
  }
  for (const char* name : {"drive-000.lcmlog", "drive-001.lcmlog", "drive-002.lcmlog"})
    EXPECT_THAT(channels(session.path() / name), ElementsAre("CONFIG", "IMU"));
}

TEST_F(SessionTest, ProcessesThatShareASectionAndDifferAreNamed) {
  RecorderNode node(config_, bus_, kSessionStart);
  send_config("tensor_voting:1", "tensor_voting:\n  a: 1\n");
  send_config("tensor_voting:2", "tensor_voting:\n  a: 2\n");
  const std::string yaml = text(folder_ / "log" / "2026-11-23T205200Z" / "config.yaml");
  EXPECT_THAT(yaml, HasSubstr("# tensor_voting:2 on ugv is configured otherwise"));
  EXPECT_EQ(yaml.find("a: 2"), std::string::npos) << "a section stands once in a YAML file";
}

TEST_F(SessionTest, TheOldestSessionsMakeRoom) {
  const fs::path first = old_session(1);
  const fs::path second = old_session(2);
  const fs::path third = old_session(3);
  FreeSpace space(config_.folder, 9'000'000'000, ten_gb_less_sessions);
  EXPECT_TRUE(space.make_room(third));
  EXPECT_EQ(space.deleted(), 2);
  EXPECT_FALSE(fs::exists(first));
  EXPECT_FALSE(fs::exists(second));
  EXPECT_TRUE(fs::exists(third / "drive-000.lcmlog"));
}

/// The clock was at 1970 at its start, and was set right later.
TEST_F(SessionTest, TheOldestIsTheOneLastWrittenTheLongestAgoWhateverItsName) {
  const fs::path older = old_session(2);
  const fs::path newer = folder_ / "log" / "1970-01-01T000010Z";
  fs::create_directory(newer);
  const auto long_ago = fs::last_write_time(older) - std::chrono::hours(24);
  for (const fs::path& path : {older / "drive-000.lcmlog", older / "config.yaml", older})
    fs::last_write_time(path, long_ago);
  std::ofstream(newer / "drive-000.lcmlog") << "log";
  EXPECT_THAT(deletable_sessions(folder_ / "log", folder_ / "log"), ElementsAre(older, newer));
  fs::last_write_time(newer, long_ago - std::chrono::hours(1));
  EXPECT_THAT(deletable_sessions(folder_ / "log", folder_ / "log"), ElementsAre(older, newer)) << "its file counts";
}

TEST_F(SessionTest, TheCurrentOneAndWhatIsNotOnlyARecordingAreNeverDeleted) {
  const fs::path current = old_session(1);
  const fs::path kept = old_session(2);
  std::ofstream(kept / "keep") << "";
  const fs::path other = folder_ / "log" / "photos";
  fs::create_directory(other);
  fs::create_directory_symlink(other, folder_ / "log" / "2026-01-05T100000Z");
  const Session written(config_.folder, kSessionStart);  // by another recorder
  std::ofstream(written.path() / "drive-000.lcmlog") << "log";
  FreeSpace space(config_.folder, 10'000'000'000, ten_gb_less_sessions);
  EXPECT_FALSE(space.make_room(current));
  EXPECT_EQ(space.deleted(), 0);
  for (const fs::path& path : {current, kept, other, written.path()}) EXPECT_TRUE(fs::exists(path)) << path;
  EXPECT_THAT(space.why_refused(), HasSubstr("less than 10 GB are free"));
}

TEST_F(SessionTest, ARecorderThatMayNotWriteSaysSoAndCountsWhatItLoses) {
  config_.keep_free = 1e6;  // more than any disk has
  RecorderNode node(config_, bus_, kSessionStart);
  bus_.publish("IMU", imu_t{});
  ASSERT_EQ(node.report().faults.size(), 1U);
  EXPECT_THAT(node.report().faults[0], HasSubstr("GB are free on the disk of"));
  EXPECT_EQ(node.report().counters["lost.unwritten"], 1);
  node.tick(kSessionStart + 2'000'000);
  EXPECT_EQ(node.report().faults.size(), 1U);
}

TEST_F(SessionTest, AFolderThatCannotBeMadeIsOneClearError) {
  std::ofstream(folder_ / "log") << "a file";
  try {
    RecorderNode node(config_, bus_, kSessionStart);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("cannot be made"));
  }
}

/// As by an operator who makes room, or where the disk of the logs is pulled out.
TEST_F(SessionTest, ThatIsDeletedMeanwhileIsRecordedAgainAndSaysSo) {
  RecorderNode recorder(config_, bus_, kSessionStart);
  const auto record = [&](std::int64_t second) {
    bus_.publish("IMU", imu_t{});
    bus_.dispatch();
    recorder.tick(kSessionStart + second * 1'000'000);
  };
  record(1);
  EXPECT_THAT(recorder.report().faults, ::testing::IsEmpty());
  fs::remove_all(config_.folder);
  record(2);
  EXPECT_THAT(recorder.report().faults, ElementsAre(HasSubstr("was deleted while it was written")));
  EXPECT_EQ(recorder.report().counters["lost.unwritten"], 1);
  EXPECT_EQ(recorder.report().counters["lost.deleted"], 1);
  record(3);
  record(4);
  EXPECT_THAT(recorder.report().faults, ElementsAre(HasSubstr("with 2 messages"))) << "for a minute";
  record(70);
  EXPECT_THAT(recorder.report().faults, ::testing::IsEmpty());
  recorder.finish();
  int logs = 0;
  for (const auto& entry : fs::recursive_directory_iterator(config_.folder))
    logs += entry.path().extension() == ".lcmlog" ? 1 : 0;
  EXPECT_EQ(logs, 1);
}

}  // namespace
}  // namespace curbstone::recorder
