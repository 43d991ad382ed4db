#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <curbstone/imu_t.hpp>
#include <thread>

#include "common/bus/lcm_bus.hpp"
#include "common/bus/local_bus.hpp"
#include "common/log/log_writer.hpp"
#include "common/time/clock.hpp"
#include "tests/stamps.hpp"
#include "tests/temporary_folder.hpp"
#include "tools/command/run_subcommand.hpp"
#include "tools/play/keys.hpp"
#include "tools/play/play.hpp"

namespace curbstone::play {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

using test::kStart;

class PlayTest : public ::testing::Test {
 protected:
  /// IMU messages each 100 ms for 30 s, each with a POSE.
  PlayTest() {
    LogWriter log(file_);
    for (int i = 0; i < 300; ++i) {
      imu_t message{};
      message.utime = kStart + i * 100'000;
      message.sequence = i;
      std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
      message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
      log.write("IMU", bytes.data(), static_cast<int>(bytes.size()));
      log.write("POSE", bytes.data(), static_cast<int>(bytes.size()));
    }
    bus_.tap([this](const std::string& channel, const void* data, int size, std::int64_t) {
      imu_t message;
      ASSERT_EQ(channel, "IMU");
      ASSERT_TRUE(decode(data, size, message));
      EXPECT_EQ(message.utime, kStart + message.sequence * 100'000) << "the times stay";
      heard_.push_back(message.sequence);
    });
  }
  [[nodiscard]] Player player() {
    return Player({file_}, bus_, [](const std::string& channel) { return channel == "IMU"; });
  }
  std::vector<int> take() { return std::exchange(heard_, {}); }

  test::TemporaryFolder folder_;
  std::string file_ = folder_ / "drive.lcmlog";
  LocalBus bus_;
  std::vector<int> heard_;
};

TEST_F(PlayTest, SaysWhatIsDueAtThePaceOfTheRecords) {
  Player player = this->player();
  player.advance(5'000'000);
  EXPECT_THAT(take(), ElementsAre(0));
  player.advance(5'099'999);
  EXPECT_THAT(take(), ElementsAre());
  player.advance(5'100'000);
  EXPECT_THAT(take(), ElementsAre(1));
  player.set_speed(3);
  player.advance(5'200'000);
  EXPECT_THAT(take(), ElementsAre(2, 3, 4));
}

TEST_F(PlayTest, ACallerWhoWasHeldUpGetsNoBurst) {
  Player player = this->player();
  player.advance(0);
  player.advance(20'000'000);
  EXPECT_THAT(take(), ElementsAre(0, 1));
}

TEST_F(PlayTest, FollowsAClockThatWasSetAndGoesOnWhereNothingWasRecorded) {
  {
    LogWriter log(file_);
    imu_t message{};
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
    for (int i = 0; i < 12; ++i) {
      message.utime = kStart + i * 100'000;
      message.sequence = i;
      message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
      const std::int64_t clock = i < 4 ? 0 : i < 8 ? 50 * 31'536'000'000'000 : -3'600'000'000;  // 50 years; an hour
      log.write("IMU", bytes.data(), static_cast<int>(bytes.size()), message.utime + clock);
    }
  }
  Player player = this->player();
  std::vector<int> heard;
  for (std::int64_t now = 0; now < 1'500'000 && !player.at_end(); now += 100'000) {
    player.advance(now);
    const std::vector<int> more = take();
    EXPECT_LE(more.size(), 2U) << "no burst";
    heard.insert(heard.end(), more.begin(), more.end());
  }
  EXPECT_TRUE(player.at_end());
  EXPECT_EQ(heard.size(), 12U);
}

TEST_F(PlayTest, KeysPauseStepLeapAndChangeTheSpeed) {
  Player player = this->player();
  player.advance(0);
  take();
  EXPECT_TRUE(apply_keys(" ", player));
  player.advance(100'000);
  EXPECT_THAT(take(), ElementsAre());
  apply_keys("..", player);
  EXPECT_THAT(take(), ElementsAre(1, 2));
  apply_keys(" \x1b[C", player);
  player.advance(200'000);
  EXPECT_THAT(take(), ElementsAre(102, 103)) << "10 s on";
  apply_keys("\x1b[D\x1b[D", player);
  EXPECT_EQ(player.position(), 0) << "not before the beginning";
  apply_keys("++-", player);
  EXPECT_EQ(player.speed(), 2);
  EXPECT_FALSE(apply_keys("q", player));
}

TEST_F(PlayTest, EndsAtTheEnd) {
  Player player = this->player();
  player.seek(29'850'000);
  player.advance(0);
  EXPECT_FALSE(player.at_end());
  player.advance(50'000);
  EXPECT_THAT(take(), ElementsAre(299));
  EXPECT_TRUE(player.at_end());
  player.advance(100'000);
  apply_keys("\x1b[C", player);
  EXPECT_TRUE(player.at_end());
  EXPECT_EQ(player.position(), 29'900'000) << "however long ago it ended";
  apply_keys("\x1b[D", player);
  EXPECT_FALSE(player.at_end()) << "and back again";
}

class PlayOnABus : public PlayTest {
 protected:
  int run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "play");
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    ::testing::internal::CaptureStdout();
    ::testing::internal::CaptureStderr();
    const int status = command::run_subcommand("play", run_play, static_cast<int>(argv.size()), argv.data());
    out_ = ::testing::internal::GetCapturedStdout();
    err_ = ::testing::internal::GetCapturedStderr();
    return status;
  }
  std::string out_;
  std::string err_;
};

TEST_F(PlayOnABus, SaysTheSensorsAlone) {
  EXPECT_EQ(run({file_, "--from", "28", "--speed", "10"}), 0) << err_;
  EXPECT_EQ(out_, "20 messages\n");
}

TEST_F(PlayOnABus, RefusesABusOnWhichADriverSpeaks) {
  std::atomic<bool> done = false;
  std::thread driver([&] {
    LcmBus bus;
    while (!done) {
      bus.publish("IMU", imu_t{});
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  });
  EXPECT_EQ(run({file_}), 1);
  done = true;
  driver.join();
  EXPECT_THAT(err_, HasSubstr("somebody speaks on IMU"));
  EXPECT_EQ(out_, "");
}

TEST_F(PlayOnABus, NothingToPlayIsAnError) {
  EXPECT_EQ(run({file_, "--channels", "GNSS", "--speed", "100"}), 1);
  EXPECT_THAT(err_, HasSubstr("nothing was played"));
  EXPECT_EQ(run({file_, "--channels", "("}), 1);
  EXPECT_THAT(err_, HasSubstr("no regular expression"));
}

}  // namespace
}  // namespace curbstone::play
