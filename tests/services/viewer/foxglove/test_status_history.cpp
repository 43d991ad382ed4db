#include "services/viewer/foxglove/status_history.hpp"

#include <foxglove/log.pb.h>
#include <gmock/gmock.h>

#include <limits>
#include <nlohmann/json.hpp>

namespace curbstone::viewer::foxglove {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;

service_status_t status(const std::string& name, std::int64_t seconds, std::vector<std::string> faults = {}) {
  service_status_t message{};
  message.utime = 1'000'000 * seconds;
  message.service = name;
  message.version = "1.0";
  message.pid = 42;
  message.uptime = 1'000'000 * seconds;
  message.cpu_time = 250'000 * seconds;
  message.latency_p50 = std::numeric_limits<float>::quiet_NaN();
  message.counter_name = {"packets", "dropped.queue"};
  message.counter_value = {1000, 3};
  message.num_counters = 2;
  message.fault = std::move(faults);
  message.num_faults = static_cast<std::int32_t>(message.fault.size());
  return message;
}

std::vector<std::string> texts(const StatusHistory& history) {
  std::vector<std::string> lines;
  for (const auto& line : history.lines()) lines.push_back(line.text);
  return lines;
}

TEST(StatusHistoryTest, GivesNumbersForPlotsUnderNamesThatNeedNoQuotes) {
  StatusHistory history;
  history.put(status("tensor_voting:1", 10));
  history.put(status("tensor_voting:1", 12));
  ASSERT_EQ(history.services().size(), 1U);
  EXPECT_EQ(history.services()[0].topic, "/status/tensor_voting_1");
  const json said = json::parse(history.services()[0].json);
  EXPECT_EQ(said["counters"]["dropped_queue"], 3);
  EXPECT_DOUBLE_EQ(said["cpu"], 0.25);
  EXPECT_TRUE(said["latency_p50"].is_null());
}

TEST(StatusHistoryTest, TellsWhenAFaultBeginsAndEnds) {
  StatusHistory history;
  history.put(status("lidar", 1));
  history.put(status("lidar", 2, {"no packets", "hot"}));
  history.put(status("lidar", 3, {"no packets"}));
  history.put(status("lidar", 4));
  EXPECT_THAT(texts(history),
              ElementsAre("runs: 1.0, process 42", "hot", "no packets", "no longer: hot", "no longer: no packets"));
  EXPECT_EQ(history.lines()[1].level, StatusHistory::Level::kError);
  EXPECT_EQ(history.lines()[4].level, StatusHistory::Level::kInfo);
  EXPECT_EQ(history.lines()[4].utime, 4'000'000);
}

TEST(StatusHistoryTest, TellsThatAProcessIsAnotherOne) {
  StatusHistory history;
  history.put(status("lidar", 100));
  service_status_t next = status("lidar", 1);
  next.pid = 43;
  history.put(next);
  EXPECT_THAT(texts(history), ElementsAre("runs: 1.0, process 42", "runs: 1.0, process 43"));
  EXPECT_EQ(json::parse(history.services()[0].json)["cpu"], 0);
}

TEST(StatusHistoryTest, IsBoundedWhateverComes) {
  StatusHistory history;
  for (int i = 0; i < 200; ++i) {
    service_status_t message =
        status("p" + std::to_string(i), 1, std::vector<std::string>(100, std::string(5000, 'x')));
    for (int k = 0; k < 100; ++k)
      message.fault[static_cast<std::size_t>(k)] = std::to_string(k) + std::string(5000, 'x');
    EXPECT_EQ(history.put(message), i < 64);
  }
  EXPECT_EQ(history.services().size(), StatusHistory::kMaxServices);
  EXPECT_EQ(history.lines().size(), StatusHistory::kMaxLines);
  EXPECT_LE(history.lines().back().text.size(), StatusHistory::kMaxText);
}

TEST(LogMessageTest, IsUtf8WhateverTheProcessSaid) {
  StatusHistory history;
  history.put(status("lidar\xff", 1, {"hot \xc3\x28"}));
  ::foxglove::Log log;
  ASSERT_TRUE(log.ParseFromString(log_message(history.lines()[1])));
  EXPECT_EQ(log.level(), ::foxglove::Log::ERROR);
  EXPECT_EQ(log.message(), "hot \xef\xbf\xbd(");
  EXPECT_EQ(log.name(), "lidar\xef\xbf\xbd");
  EXPECT_EQ(log.timestamp().seconds(), 1);
}

}  // namespace
}  // namespace curbstone::viewer::foxglove
