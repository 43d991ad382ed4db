#include <gtest/gtest.h>

#include <curbstone/imu_t.hpp>
#include <filesystem>
#include <fstream>

#include "common/log/log_reader.hpp"
#include "common/log/log_writer.hpp"
#include "common/log/message_order.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone {
namespace {

std::vector<std::uint8_t> encoded(std::int64_t utime) {
  imu_t message{};
  message.utime = utime;
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, message.getEncodedSize());
  return bytes;
}

void write_log(const std::string& file, int events) {
  LogWriter log(file);
  for (int i = 0; i < events; ++i) {
    const auto bytes = encoded(1000 + i);
    log.write("IMU", bytes.data(), static_cast<int>(bytes.size()));
  }
}

TEST(Log, ReadsBackWhatWasWritten) {
  const test::TemporaryFolder folder;
  write_log(folder / "whole.lcmlog", 3);
  LogReader reader(folder / "whole.lcmlog");
  for (int i = 0; i < 3; ++i) {
    const auto event = reader.next();
    ASSERT_TRUE(event);
    EXPECT_EQ(event->channel, "IMU");
    EXPECT_EQ(event->log_utime, 1000 + i);
    EXPECT_EQ(event->bytes, encoded(1000 + i));
  }
  EXPECT_FALSE(reader.next());
  EXPECT_FALSE(reader.loss().damaged());
  EXPECT_EQ(to_text(reader.loss()), "");
  EXPECT_EQ(reader.progress(), 1.0);
}

TEST(Log, SaysWhenItIsCutOff) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "cut.lcmlog";
  write_log(file, 3);
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 10);
  LogReader reader(file);
  EXPECT_TRUE(reader.next());
  EXPECT_TRUE(reader.next());
  EXPECT_FALSE(reader.next());
  EXPECT_FALSE(reader.loss().damaged());
  EXPECT_GT(reader.loss().cut_off, 0);
}

TEST(Log, RefusesWhatIsNoLogInOneLine) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "text") << "no log\n";
  for (const std::string path : {folder / "text", folder / "absent", folder.path()}) {
    try {
      LogReader reader(path);
      FAIL() << path;
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find(path), std::string::npos);
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
}

TEST(Log, RefusesToWriteWhereItCannot) {
  EXPECT_THROW(LogWriter("/nonexistent/x.lcmlog"), std::runtime_error);
}

TEST(MessageOrder, SortsByMessageTimeWithinTheWindowAndKeepsTies) {
  MessageOrder order(100);
  std::vector<std::int64_t> out;
  const auto drain = [&](bool all) {
    while (const auto event = order.pop(all)) out.push_back(message_time(*event));
  };
  const std::int64_t times[] = {100, 300, 200, 200, 500};
  for (std::int64_t i = 0; i < 5; ++i) {
    order.push({300 + 60 * i, "IMU", encoded(times[i])});
    drain(false);
  }
  drain(true);
  EXPECT_EQ(out, (std::vector<std::int64_t>{100, 200, 200, 300, 500}));
}

/// The message times as they come out, of events that are logged at `logged` ms.
std::vector<std::int64_t> sorted(const std::vector<std::int64_t>& logged, const std::vector<std::int64_t>& times) {
  MessageOrder order(100);
  std::vector<std::int64_t> out;
  for (std::size_t i = 0; i < logged.size(); ++i) {
    order.push({logged[i], "IMU", encoded(times[i])});
    while (const auto event = order.pop(false)) out.push_back(message_time(*event));
  }
  while (const auto event = order.pop(true)) out.push_back(message_time(*event));
  return out;
}

TEST(MessageOrder, AWrongTimeInTheLogCostsNoOrderBehindIt) {
  constexpr std::int64_t kWrong = std::int64_t{1} << 60;
  EXPECT_EQ(sorted({10, kWrong, 30, 40, 50, 60}, {1, 2, 5, 3, 6, 4}), (std::vector<std::int64_t>{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(sorted({10, -kWrong, 30, 40, 50, 60}, {1, 2, 5, 3, 6, 4}), (std::vector<std::int64_t>{1, 2, 3, 4, 5, 6}));
}

TEST(MessageOrder, AClockThatWasSetBackIsFollowed) {
  EXPECT_EQ(sorted({10'000, 10'010, 500, 510, 520, 530}, {1, 2, 5, 3, 6, 4}),
            (std::vector<std::int64_t>{1, 2, 3, 4, 5, 6}));
}

/// Both sensors' stamps go back, one a little later than the other: what was driven before is not mixed with what
/// comes.
TEST(MessageOrder, AVehicleWhoseClockWasSetBackIsFollowed) {
  EXPECT_EQ(
      sorted({9'000, 9'010, 9'020, 8'530, 8'540, 8'550, 8'560}, {9'010, 9'000, 9'020, 8'520, 8'540, 8'530, 8'560}),
      (std::vector<std::int64_t>{9'000, 9'010, 9'020, 8'520, 8'530, 8'540, 8'560}));
}

TEST(MessageOrder, WhereTheTimesStandStillTheWaitIsBounded) {
  MessageOrder order(100);
  std::size_t waiting = 0;
  for (std::size_t i = 0; i < MessageOrder::kMaxWaiting + 100; ++i) {
    order.push({7, "IMU", encoded(static_cast<std::int64_t>(i))});
    ++waiting;
    while (order.pop(false)) --waiting;
  }
  EXPECT_EQ(waiting, MessageOrder::kMaxWaiting);
}

TEST(MessageOrder, ShortMessagesHaveTimeZero) {
  EXPECT_EQ(message_time("abc", 3), 0);
}

}  // namespace
}  // namespace curbstone
