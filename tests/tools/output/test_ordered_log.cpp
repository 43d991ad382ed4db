#include "tools/output/ordered_log.hpp"

#include <gtest/gtest.h>

#include <curbstone/imu_t.hpp>
#include <vector>

#include "common/log/log_writer.hpp"
#include "common/log/message_order.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::output {
namespace {

void write(LogWriter& log, const std::string& channel, std::int64_t utime, std::int64_t logged) {
  imu_t message{};
  message.utime = utime;
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, message.getEncodedSize());
  log.write(channel, bytes.data(), static_cast<int>(bytes.size()), logged);
}

TEST(OrderedLogTest, GivesTheWantedChannelsInTheOrderOfMessageTime) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "a.lcmlog";
  {
    LogWriter log(file);
    write(log, "IMU", 2'000'000, 2'001'000);
    write(log, "MAP_POSE", 1'500'000, 2'002'000);
    write(log, "WHEELS", 1'900'000, 2'003'000);
    write(log, "LIDAR_POINTS", 1'400'000, 2'050'000);
  }
  WatchedLog log(file, "test");
  std::vector<std::int64_t> times;
  read_in_order(log, is_of_a_driver, [&](const LogEvent& event) { times.push_back(message_time(event)); });
  EXPECT_EQ(times, (std::vector<std::int64_t>{1'400'000, 1'900'000, 2'000'000}));
}

}  // namespace
}  // namespace curbstone::output
