#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <curbstone/imu_t.hpp>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

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

TEST(Log, SaysWhatAFileIsThatIsNoLog) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "run";
  const auto said_of = [&](const std::string& bytes) -> std::string {
    std::ofstream(file, std::ios::binary) << bytes;
    try {
      LogReader reader(file);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_EQ(said_of(""), file + ": not an LCM log: it is empty");
  EXPECT_EQ(said_of("\x1F\x8B\x08 and on"),
            file + ": not an LCM log, but a file compressed by gzip: unpack it first (gunzip)");
  EXPECT_EQ(said_of("\xED\xA1\xDA\x01"), "no error") << "a record that is cut off";
}

TEST(Log, RefusesToWriteWhereItCannot) {
  EXPECT_THROW(LogWriter("/nonexistent/x.lcmlog"), std::runtime_error);
}

TEST(MessageOrder, SortsByMessageTimeWithinTheWindowAndKeepsTies) {
  MessageOrder order(100);
  std::vector<std::int64_t> out;
  const std::int64_t times[] = {100, 300, 200, 300, 500};
  for (std::int64_t i = 0; i < 5; ++i) {
    order.push({300 + 60 * i, i % 2 == 0 ? "IMU" : "WHEELS", encoded(times[i])});
    while (const auto event = order.pop()) out.push_back(message_time(*event));
  }
  while (const auto event = order.pop_rest()) out.push_back(message_time(*event));
  EXPECT_EQ(out, (std::vector<std::int64_t>{100, 200, 300, 300, 500}));
}

/// The message times as they come out, of events of two channels by turns that are logged at `logged` ms.
std::vector<std::int64_t> sorted(const std::vector<std::int64_t>& logged, const std::vector<std::int64_t>& times) {
  MessageOrder order(100);
  std::vector<std::int64_t> out;
  for (std::size_t i = 0; i < logged.size(); ++i) {
    order.push({logged[i], i % 2 == 0 ? "IMU" : "WHEELS", encoded(times[i])});
    while (const auto event = order.pop()) out.push_back(message_time(*event));
  }
  while (const auto event = order.pop_rest()) out.push_back(message_time(*event));
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
  EXPECT_EQ(sorted({9'012, 9'014, 9'024, 9'026, 8'532, 8'534, 8'552, 8'554},
                   {9'010, 9'012, 9'020, 9'022, 8'530, 8'528, 8'550, 8'540}),
            (std::vector<std::int64_t>{9'010, 9'012, 9'020, 9'022, 8'528, 8'530, 8'540, 8'550}));
}

/// One sensor's stamps step back by 700 ms and later ahead again, and one of its stamps is damaged. Its messages keep
/// the place at which the vehicle heard them.
TEST(MessageOrder, AChannelWhoseClockAloneIsSetKeepsItsPlace) {
  MessageOrder order;
  std::vector<std::string> out;
  std::vector<std::string> expected;
  for (std::int64_t ms = 1'000; ms < 9'000; ms += 10) {
    const bool is_lidar = ms % 20 == 0;
    const std::int64_t off = !is_lidar ? 0 : ms == 4'000 ? 3'000 : ms >= 5'000 && ms < 7'000 ? -700 : 0;
    expected.emplace_back(is_lidar ? "LIDAR" : "IMU");
    order.push({1000 * (ms + 3), expected.back(), encoded(1000 * (ms + off))});
    while (const auto event = order.pop()) out.push_back(event->channel);
  }
  while (const auto event = order.pop_rest()) out.push_back(event->channel);
  EXPECT_EQ(out, expected);
}

/// A stamp that is early or late by less than the window does not make its packet overtake others of its channel.
TEST(MessageOrder, EventsOfAChannelKeepTheirLoggedOrder) {
  EXPECT_EQ(sorted({10, 12, 20, 22, 30, 32, 40, 42}, {10, 11, 90, 21, 30, 31, 40, 41}),
            (std::vector<std::int64_t>{10, 11, 21, 31, 41, 90, 30, 40}));
}

TEST(MessageOrder, AChannelInAnotherClockFromTheBeginningKeepsItsPlace) {
  constexpr std::int64_t kHour = 3'600'000'000;
  MessageOrder order;
  int since_imu = 0;
  int most = 0;
  for (std::int64_t us = kHour; us < kHour + 2'000'000; us += 10'000) {
    const bool is_lidar = us % 20'000 == 0;
    order.push({us, is_lidar ? "LIDAR" : "IMU", encoded(is_lidar ? us + kHour : us)});
    while (const auto event = order.pop()) {
      since_imu = event->channel == "IMU" ? 0 : since_imu + 1;
      most = std::max(most, since_imu);
    }
  }
  EXPECT_EQ(most, 1);
}

/// A gap in a log is no step of a clock.
TEST(MessageOrder, AfterAGapTheOrderIsExact) {
  MessageOrder order;
  std::vector<std::int64_t> out;
  std::int64_t ms = 1'000;
  for (int i = 0; i < 600; ++i) {
    ms += i == 300 ? 30'000 : 10;
    const std::int64_t latency = i % 2 == 0 ? 35 : 2;
    order.push({1000 * (ms + 40), i % 2 == 0 ? "LIDAR" : "IMU", encoded(1000 * (ms + 40 - latency))});
    while (const auto event = order.pop()) out.push_back(message_time(*event));
  }
  while (const auto event = order.pop_rest()) out.push_back(message_time(*event));
  EXPECT_TRUE(std::is_sorted(out.begin(), out.end()));
}

/// How many of 3000 events of three channels, each logged at its time, came out at a time() that is more than 0.1 s
/// from it. From 10 s on there is a gap of `gap` ms, and the stamps of one channel are `off` ms too late.
int told_wrong(std::int64_t gap, std::int64_t off) {
  MessageOrder order;
  int wrong = 0;
  const auto look = [&](const LogEvent& event) {
    if (std::abs(order.time() - event.log_utime) > 100'000) ++wrong;
  };
  const char* const channels[] = {"IMU", "LIDAR", "WHEELS"};
  for (std::int64_t i = 0; i < 3'000; ++i) {
    const bool is_later = i >= 1'500;
    const std::int64_t ms = 1'000 + 10 * i + (is_later ? gap : 0);
    order.push({1000 * ms, channels[i % 3], encoded(1000 * (ms + (is_later && i % 3 == 1 ? off : 0)))});
    while (const auto event = order.pop()) look(*event);
  }
  while (const auto event = order.pop_rest()) look(*event);
  return wrong;
}

/// So a replay tells its nodes the time as they heard it live: an epoch that begins after a gap is not ahead of it.
TEST(MessageOrder, ItsTimeGoesOnAfterAGapAndWithoutTheStepsOfOneChannel) {
  EXPECT_LE(told_wrong(78'000, 0), 1) << "the first of most channels";
  EXPECT_EQ(told_wrong(0, 3'000), 0);
  EXPECT_EQ(told_wrong(0, -3'000), 0);
}

TEST(MessageOrder, WhereTheTimesStandStillTheWaitIsBounded) {
  MessageOrder order(100);
  std::size_t waiting = 0;
  for (std::size_t i = 0; i < MessageOrder::kMaxWaiting + 100; ++i) {
    order.push({7, "IMU", encoded(static_cast<std::int64_t>(i))});
    ++waiting;
    while (order.pop()) --waiting;
  }
  EXPECT_EQ(waiting, MessageOrder::kMaxWaiting);
}

TEST(MessageOrder, ShortMessagesHaveTimeZero) {
  EXPECT_EQ(message_time("abc", 3), 0);
}

}  // namespace
}  // namespace curbstone
