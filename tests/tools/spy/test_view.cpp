#include "tools/spy/view.hpp"

#include <gmock/gmock.h>

#include <curbstone/imu_t.hpp>
#include <nlohmann/json.hpp>

#include "tests/stamps.hpp"
#include "tests/tools/spy/encoded.hpp"

namespace curbstone::spy {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::StartsWith;

using test::kStart;

template <class Message>
void receive(board::BusBoard& board, const std::string& channel, const Message& message, std::int64_t now) {
  const auto bytes = encoded(message);
  board.on_message(channel, bytes.data(), bytes.size(), now);
}

board::BusBoard a_second(const std::string& followed) {
  board::BusBoard board(followed);
  for (int k = 0; k <= 100; ++k) {
    imu_t imu{};
    imu.sequence = k == 50 ? 49 : k;  // 49 comes twice, and 50 is missing
    receive(board, "IMU", imu, kStart + k * 10'000);
  }
  service_status_t status = status_of("ekf", 1'000'000);
  status.fault = {"no IMU: \x1b[2J"};
  status.num_faults = 1;
  status.latency_p50 = 0.002F;
  receive(board, "SERVICE_STATUS", status, kStart + 1'000'000);
  return board;
}

TEST(SpyView, HasARowAChannelAndAService) {
  const auto lines = board_lines(a_second(""), kStart + 1'000'000, {});
  EXPECT_THAT(lines, Contains(AllOf(StartsWith("IMU"), HasSubstr("100.0"), HasSubstr("curbstone.imu_t"))));
  EXPECT_THAT(lines, Contains(AllOf(StartsWith("ekf"), HasSubstr("2.0"), HasSubstr("no IMU: ?[2J"))));
  EXPECT_THAT(board_lines(a_second(""), kStart + 9'000'000, {}),
              Contains(AllOf(StartsWith("ekf"), HasSubstr("SILENT"))));
}

TEST(SpyView, AnEmptyBusIsSaidInWords) {
  EXPECT_THAT(board_lines(board::BusBoard(""), kStart, {}), Contains(HasSubstr("curbstone doctor")));
  EXPECT_THAT(message_lines(board::BusBoard("IMU"), kStart, {}), Contains("IMU: nothing comes"));
}

TEST(SpyView, AFollowedMessageIsShownFieldByField) {
  const auto lines = message_lines(a_second("IMU"), kStart + 1'000'000, {});
  EXPECT_THAT(lines, Contains(AllOf(StartsWith("sequence "), HasSubstr("100"))));
  EXPECT_THAT(lines, Contains(StartsWith("utime ")));
}

TEST(SpyView, JsonHasFiguresForPrograms) {
  const auto json = nlohmann::json::parse(board_json(a_second("IMU"), kStart + 1'000'000));
  ASSERT_EQ(json["channels"].size(), 2U);
  EXPECT_DOUBLE_EQ(json["channels"][0]["rate_hz"].get<double>(), 100.0);
  EXPECT_EQ(json["channels"][0]["lost"], 1);
  EXPECT_EQ(json["channels"][1]["lost"], nullptr);
  EXPECT_EQ(json["services"][0]["cpu_cores"], nullptr) << "not known before the second status";
  EXPECT_EQ(json["services"][0]["faults"][0], "no IMU: ?[2J");
  EXPECT_EQ(json["message"]["sequence"], 100);
}

}  // namespace
}  // namespace curbstone::spy
