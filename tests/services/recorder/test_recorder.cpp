#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <curbstone/imu_t.hpp>
#include <filesystem>

#include "common/bus/local_bus.hpp"
#include "common/log/log_reader.hpp"
#include "services/recorder/recorder_node.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::recorder {
namespace {

constexpr std::int64_t kStart = 1'795'467'120'000'000;  // 2026-11-23T20:52:00Z, us

class RecorderTest : public ::testing::Test {
 protected:
  RecorderTest() { config_.file = folder_ / "drive.lcmlog"; }

  void send(int first, int last) {
    for (imu_t message{}; first <= last; ++first) {
      message.utime = message.sequence = first;
      bus_.publish("IMU", message);
    }
  }
  [[nodiscard]] std::vector<int> heard(const std::string& suffix = "") const {
    LogReader reader(config_.file + suffix);
    std::vector<int> sequences;
    while (const auto event = reader.next()) {
      imu_t message;
      if (message.decode(event->bytes.data(), 0, static_cast<int>(event->bytes.size())) < 0) break;
      EXPECT_EQ(event->channel, "IMU");
      sequences.push_back(message.sequence);
    }
    return sequences;
  }
  [[nodiscard]] bool exists(const std::string& suffix) const { return std::filesystem::exists(config_.file + suffix); }

  test::TemporaryFolder folder_;
  RecorderConfig config_;
  LocalBus bus_;
};

TEST_F(RecorderTest, WritesWhatIsSaidOnAnyChannelInItsOrder) {
  RecorderNode node(config_, bus_, kStart);
  send(1, 3);
  node.finish();
  EXPECT_EQ(heard(), (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(node.report().counters["messages"], 3);
}

TEST_F(RecorderTest, WritesOnWhenTheHostsClockIsSetBack) {
  RecorderNode node(config_, bus_, kStart);
  send(1, 1);
  node.tick(kStart + 1'000'000);
  EXPECT_EQ(heard(), (std::vector<int>{1}));
  send(2, 2);
  node.tick(kStart + 1'020'000 - 3'600'000'000);
  EXPECT_EQ(heard(), (std::vector<int>{1, 2})) << "not an hour later";
}

TEST_F(RecorderTest, LeavesOutTheVotesUnlessToldOtherwise) {
  const auto record = [this] {
    RecorderNode node(config_, bus_, kStart);
    bus_.publish("VOTED_POINTS", imu_t{});
    send(1, 1);
    node.finish();
    return node.report().counters["messages"];
  };
  EXPECT_EQ(record(), 1);
  config_.skip.clear();
  EXPECT_EQ(record(), 2);
}

TEST_F(RecorderTest, WhatWasSaidASecondAgoIsOnFileBeforeTheEnd) {
  RecorderNode node(config_, bus_, kStart);
  node.tick(10'000'000);
  send(1, 3);
  node.tick(11'000'000);
  EXPECT_EQ(heard(), (std::vector<int>{1, 2, 3}));
}

TEST_F(RecorderTest, NeverOverwritesALog) {
  {
    RecorderNode node(config_, bus_, kStart);
    send(1, 2);
  }
  {
    RecorderNode node(config_, bus_, kStart);
    send(3, 4);
  }
  EXPECT_EQ(heard(), (std::vector<int>{1, 2}));
  EXPECT_EQ(heard(".1"), (std::vector<int>{3, 4}));
}

/// `file: /data` would be written to /data.1, on the disk of the system.
TEST_F(RecorderTest, AFolderIsNoFile) {
  config_.file = (folder_ / ".").string();
  try {
    RecorderNode node(config_, bus_, kStart);
    FAIL() << "it records";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()),
              "recorder.file: " + config_.file + " is a folder: name a file in it, or set recorder.folder to it");
  }
  EXPECT_FALSE(std::filesystem::exists(config_.file + ".1"));
}

TEST_F(RecorderTest, GoesOnInTheNextFileWhenOneIsFull) {
  const std::int64_t record = 28 + 3 + imu_t{}.getEncodedSize();
  Recording recording([this] { return unused_name(config_.file); }, 2 * record);
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(imu_t{}.getEncodedSize()));
  imu_t message{};
  for (message.sequence = 1; message.sequence <= 5; ++message.sequence) {
    message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    recording.write("IMU", bytes.data(), static_cast<int>(bytes.size()), message.sequence);
  }
  recording.flush();
  EXPECT_EQ(heard(), (std::vector<int>{1, 2}));
  EXPECT_EQ(heard(".1"), (std::vector<int>{3, 4}));
  EXPECT_EQ(heard(".2"), (std::vector<int>{5}));
}

TEST_F(RecorderTest, AFolderThatIsNotThereIsOneClearError) {
  config_.file = folder_ / "nowhere" / "drive.lcmlog";
  try {
    RecorderNode node(config_, bus_, kStart);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()), config_.file + ": cannot be written: No such file or directory");
  }
}

TEST_F(RecorderTest, SaysThatTheDiskIsFullAndGoesOnWhenThereIsRoomAgain) {
  RecorderNode node(config_, bus_, kStart);
  node.tick(10'000'000);
  send(1, 3);
  node.tick(11'000'000);

  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  rlimit full = before;
  full.rlim_cur = 0;
  setrlimit(RLIMIT_FSIZE, &full);
  send(4, 6);
  node.tick(12'000'000);
  ASSERT_EQ(node.report().faults.size(), 1U);
  EXPECT_NE(node.report().faults[0].find("cannot be written"), std::string::npos);
  send(7, 9);
  EXPECT_EQ(node.report().counters["lost.unwritten"], 6);
  for (int second = 13; second < 17; ++second) {  // tries in vain, and leaves no heap of empty files
    node.tick(second * 1'000'000);
    send(10, 10);
    EXPECT_FALSE(node.report().faults.empty());
  }

  setrlimit(RLIMIT_FSIZE, &before);
  node.tick(20'000'000);
  node.tick(21'000'000);
  EXPECT_TRUE(node.report().faults.empty());
  send(11, 12);
  node.finish();
  EXPECT_EQ(heard(), (std::vector<int>{1, 2, 3})) << "what was written before stays";
  ASSERT_TRUE(exists(".1"));
  const std::vector<int> after = heard(".1");
  ASSERT_GE(after.size(), 2U);
  EXPECT_EQ((std::vector<int>{after.end() - 2, after.end()}), (std::vector<int>{11, 12}));
  EXPECT_FALSE(exists(".2"));
}

}  // namespace
}  // namespace curbstone::recorder
