#include "tools/exporter/metrics_text.hpp"

#include <gmock/gmock.h>

#include <curbstone/imu_t.hpp>
#include <map>
#include <regex>
#include <sstream>

#include "tests/stamps.hpp"
#include "tests/tools/spy/encoded.hpp"

namespace curbstone::exporter {
namespace {

using test::kStart;

/// A reader of the format of its own: name and labels to value. It fails on a line that is none of the format's, on a
/// sample that does not follow its TYPE, and on one that stands twice.
std::map<std::string, double> parsed(const std::string& text) {
  static const std::regex kSample(R"re(([a-zA-Z_:][a-zA-Z0-9_:]*)(\{([a-z]+="([^"\\]|\\.)*",?)*\}) (\S+))re");
  static const std::regex kType(R"(# TYPE (\S+) (counter|gauge))");
  std::map<std::string, double> samples;
  std::istringstream lines(text);
  std::string metric;
  EXPECT_TRUE(text.ends_with("\n"));
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (line.starts_with("# HELP ")) continue;
    if (std::regex_match(line, match, kType)) {
      EXPECT_NE(metric, match[1]);
      metric = match[1];
    } else if (std::regex_match(line, match, kSample)) {
      EXPECT_EQ(match[1], metric) << line;
      EXPECT_TRUE(samples.emplace(match[1].str() + match[2].str(), std::stod(match[5])).second) << line;
    } else {
      ADD_FAILURE() << line;
    }
  }
  return samples;
}

template <class Message>
void receive(spy::board::BusBoard& board, const std::string& channel, const Message& message, std::int64_t now) {
  const auto bytes = spy::encoded(message);
  board.on_message(channel, bytes.data(), bytes.size(), now);
}

TEST(MetricsText, HasChannelsServicesAndProcesses) {
  spy::board::BusBoard board("");
  for (int k = 0; k <= 100; ++k) {
    imu_t imu{};
    imu.sequence = k;
    receive(board, "IMU", imu, kStart + k * 10'000);
  }
  service_status_t status = spy::status_of("ekf", 3'000'000);
  status.cpu_time = 1'500'000;
  status.latency_p50 = std::nanf("");
  status.fault = {"no IMU"};
  status.num_faults = 1;
  spy::set_counters(status, {{"refused.late", 7}, {"tiles_waiting", 3}});
  receive(board, "SERVICE_STATUS", status, kStart + 1'000'000);
  procman_lcm::deputy_info_t info{};
  info.utime = kStart + 1'020'000;
  info.deputy_id = "ugv";
  info.ncmds = 1;
  info.cmds.resize(1);
  info.cmds[0].cmd.command_id = "ekf";
  info.cmds[0].pid = 12;
  receive(board, "PM_INFO", info, kStart + 1'000'000);

  const auto samples = parsed(metrics_text(board, kStart + 1'000'000));
  EXPECT_EQ(samples.at(R"(curbstone_channel_messages_total{channel="IMU"})"), 101);
  EXPECT_DOUBLE_EQ(samples.at(R"(curbstone_channel_rate_hertz{channel="IMU"})"), 100);
  EXPECT_EQ(samples.at(R"(curbstone_channel_lost_total{channel="IMU"})"), 0);
  EXPECT_EQ(samples.count(R"(curbstone_channel_lost_total{channel="PM_INFO"})"), 0U) << "it has no numbers";
  EXPECT_EQ(samples.at(R"(curbstone_service_up{service="ekf",host="ugv"})"), 1);
  EXPECT_EQ(samples.at(R"(curbstone_service_faults{service="ekf",host="ugv"})"), 1);
  EXPECT_EQ(samples.at(R"(curbstone_service_cpu_seconds_total{service="ekf",host="ugv"})"), 1.5);
  EXPECT_EQ(samples.at(R"(curbstone_service_counter_total{service="ekf",host="ugv",name="refused.late"})"), 7);
  EXPECT_EQ(samples.at(R"(curbstone_service_level{service="ekf",host="ugv",name="tiles_waiting"})"), 3);
  EXPECT_EQ(samples.count(R"(curbstone_service_counter_total{service="ekf",host="ugv",name="tiles_waiting"})"), 0U);
  EXPECT_EQ(samples.count(R"(curbstone_service_latency_median_seconds{service="ekf",host="ugv"})"), 0U) << "NaN";
  EXPECT_DOUBLE_EQ(samples.at(R"(curbstone_deputy_clock_seconds{deputy="ugv"})"), 0.02);
  EXPECT_EQ(samples.at(R"(curbstone_command_running{deputy="ugv",command="ekf"})"), 1);
}

TEST(MetricsText, NamesFromTheBusCannotBreakTheFormat) {
  spy::board::BusBoard board("");
  board.on_message("a\"} 1\n\\x", "", 0, kStart);
  const auto samples = parsed(metrics_text(board, kStart));
  EXPECT_EQ(samples.at(R"(curbstone_channel_messages_total{channel="a\"} 1?\\x"})"), 1);
}

}  // namespace
}  // namespace curbstone::exporter
