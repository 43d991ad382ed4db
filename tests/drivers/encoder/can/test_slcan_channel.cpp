#include "drivers/encoder/can/slcan_channel.hpp"

#include <gmock/gmock.h>

#include <stdexcept>

#include "tests/drivers/byte_stream.hpp"

namespace curbstone::encoder::can {
namespace {

using test::from_text;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class SlcanChannelTest : public ::testing::Test {
 protected:
  /// What was sent since the last call.
  std::string sent() { return std::exchange(sent_, ""); }
  void answer(std::string_view text) { channel_.on_bytes(now_, test::from_text(text)); }
  /// Ticks ten times a second; the driver's loop ticks more often.
  void pass(std::int64_t us) {
    for (; us > 0; us -= 100'000) wait(100'000);
  }
  void wait(std::int64_t us) { channel_.tick(now_ += us); }
  void open() {
    wait(0);
    wait(100'000);
    answer("\r\r");
    sent();
    frames_ = 0;
  }

  std::int64_t now_ = 1'000'000;
  std::string sent_;
  int frames_ = 0;
  int openings_ = 0;
  SlcanChannel channel_{500,
                        {[this](auto bytes) { sent_.append(bytes.begin(), bytes.end()); },
                         [this](std::int64_t, const CanFrame&) { ++frames_; }, [this](std::int64_t) { ++openings_; }}};
};

TEST_F(SlcanChannelTest, ClosesSetsTheSpeedAndOpensEachInItsTurn) {
  wait(0);
  EXPECT_EQ(sent(), "\r\rC\r");
  answer("\a\r\r");  // to whatever: not to us
  EXPECT_EQ(sent(), "");
  wait(100'000);
  EXPECT_EQ(sent(), "S6\r");
  answer("\r");
  EXPECT_EQ(sent(), "O\r");
  EXPECT_FALSE(channel_.is_open());
  answer("\r");
  EXPECT_TRUE(channel_.is_open());
  EXPECT_EQ(openings_, 1);
}

TEST_F(SlcanChannelTest, OpensThoughTheHostsClockIsSetBackMeanwhile) {
  constexpr std::int64_t kHour = 3'600'000'000;
  wait(0);
  wait(-kHour);
  wait(100'000);
  answer("\r\r");
  EXPECT_TRUE(channel_.is_open());
}

TEST_F(SlcanChannelTest, FramesPassOnlyWhileItIsOpen) {
  channel_.send(CanFrame::make(0x601, {1}));
  answer("t1811AA\r");
  EXPECT_EQ(frames_, 0);
  EXPECT_EQ(channel_.counters()["dropped.not_open"], 1);
  open();
  channel_.send(CanFrame::make(0x601, {1}));
  EXPECT_EQ(sent(), "t601101\r");
  answer("z\rt1811AA\r");
  EXPECT_EQ(frames_, 1);
}

TEST_F(SlcanChannelTest, AnAdapterThatNeverAnswersIsUsedOnTrust) {
  wait(0);
  wait(100'000);
  wait(300'000);
  wait(300'000);
  EXPECT_TRUE(channel_.is_open());
}

TEST_F(SlcanChannelTest, ARefusalIsReportedAndTriedAgain) {
  wait(0);
  wait(100'000);
  answer("\a\a");
  EXPECT_THAT(channel_.faults(), ElementsAre(HasSubstr("refuses to open")));
  sent();
  wait(1'000'000);
  EXPECT_EQ(sent(), "\r\rC\r");
}

TEST_F(SlcanChannelTest, ASilentAdapterIsReportedAndOpenedAgain) {
  open();
  pass(900'000);
  EXPECT_EQ(sent(), "");
  pass(1'000'000);
  EXPECT_EQ(sent(), "F\r");
  pass(100'000);
  EXPECT_THAT(channel_.faults(), ElementsAre(HasSubstr("nothing from the SLCAN adapter")));
  EXPECT_EQ(sent(), "\r\rC\r");
}

/// NTP sets a clock that began in 1970, in mid-drive: closing the channel would lose a moment of the wheels.
TEST_F(SlcanChannelTest, AClockThatIsSetForwardIsNoSilence) {
  constexpr std::int64_t kYears = 1'800'000'000'000'000;
  open();
  answer("t1811AA\r");
  wait(20'000);
  wait(kYears);
  EXPECT_TRUE(channel_.is_open());
  EXPECT_THAT(channel_.faults(), IsEmpty());
  answer("t1811AA\r");
  pass(2'000'000);
  EXPECT_FALSE(channel_.is_open()) << "a silence afterwards is one";
}

TEST_F(SlcanChannelTest, BellsToWhatWeSentMeanThatItWasClosedBellsOutOfTheBlueNothing) {
  open();
  for (int i = 0; i < 20; ++i) answer("\a");
  EXPECT_TRUE(channel_.is_open());
  for (int i = 0; i < 5; ++i) {
    channel_.send(CanFrame::make(0x601, {1}));
    answer("\a");
  }
  EXPECT_FALSE(channel_.is_open());
}

TEST_F(SlcanChannelTest, TheErrorFlagsAreAskedForEachSecondAndAreAFaultWhileTheyLast) {
  open();
  for (int second = 0; second < 10; ++second) {
    wait(1'000'000);
    EXPECT_EQ(sent(), "F\r");
    answer(second == 3 ? "FA4\r" : second == 7 ? "F40\r" : "F00\r");
    answer("t1811AA\r");
    EXPECT_EQ(channel_.faults().empty(), second < 3 || second > 6) << second;
    if (second == 4) {
      EXPECT_THAT(channel_.faults(), ElementsAre(HasSubstr("reports bus error, error passive, error warning:")));
    }
  }
  EXPECT_EQ(channel_.counters()["slcan.bus_error"], 1);
  EXPECT_EQ(channel_.counters()["slcan.error_passive"], 1);
  EXPECT_EQ(channel_.counters()["slcan.error_warning"], 1);
  EXPECT_EQ(channel_.counters()["slcan.arbitration_lost"], 1);
}

/// A terminator is missing: the controller is error passive for as long as that lasts, and frames come.
TEST_F(SlcanChannelTest, ErrorPassiveForAMinuteIsOneFaultForAMinuteAndEachFramePasses) {
  open();
  for (int second = 0; second < 80; ++second) {
    wait(1'000'000);
    const bool passive = second >= 5 && second < 65;
    if (sent() == "F\r") answer(passive ? "F20\r" : "F00\r");
    answer("t1811AA\r");
    if (passive) {
      ASSERT_THAT(channel_.faults(), ElementsAre(HasSubstr("reports error passive:"))) << second;
    }
    if (second < 5 || second > 68) {
      ASSERT_THAT(channel_.faults(), IsEmpty()) << second;
    }
  }
  EXPECT_EQ(channel_.counters()["slcan.error_passive"], 60);
  EXPECT_EQ(channel_.counters()["slcan.openings"], 1);
  EXPECT_EQ(frames_, 80);
}

/// A controller that is bus-off hears nothing. Its adapter answers to commands, and may have to be opened to recover.
TEST_F(SlcanChannelTest, ABusOffForAMinuteIsOneFaultAndTheChannelIsOpenedAgainAndAgain) {
  open();
  answer("t1811AA\r");
  for (int tick = 0; tick < 600; ++tick) {
    wait(100'000);
    const std::string command = sent();
    if (command.find('C') != std::string::npos) answer("\r\r\r");
    if (command.starts_with("S") || command.starts_with("O")) answer("\r");
    if (command == "F\r") answer("FA0\r");
    if (tick % 10 == 0 && channel_.is_open()) {  // the driver asks its drive for something
      channel_.send(CanFrame::make(0x601, {1}));
      answer("\r");
    }
    if (tick > 25) {
      ASSERT_THAT(channel_.faults(), Contains(HasSubstr("answers, and no frame comes: bus-off"))) << tick;
    }
  }
  const std::int64_t openings = channel_.counters()["slcan.openings"];
  EXPECT_GE(openings, 15);
  EXPECT_LE(openings, 31);  // at most each 2 s
  EXPECT_EQ(frames_, 1);
  for (int tick = 0; tick < 50; ++tick) {
    wait(100'000);
    const std::string command = sent();
    if (command.find('C') != std::string::npos || command.starts_with("S") || command.starts_with("O")) answer("\r");
    if (command == "F\r") answer("F00\r");
    answer("t1811AA\r");
  }
  EXPECT_THAT(channel_.faults(), IsEmpty());
  EXPECT_LE(channel_.counters()["slcan.openings"], openings + 1);
  EXPECT_GE(frames_, 40);
}

TEST_F(SlcanChannelTest, AnAdapterWithoutErrorFlagsIsAskedNoMoreAndThatIsCounted) {
  open();
  std::string all;
  for (int second = 0; second < 10; ++second) {
    wait(1'000'000);
    all += sent();
    answer("\at1811AA\r");
  }
  EXPECT_EQ(all, "F\rF\r");
  EXPECT_EQ(channel_.counters()["slcan.flags_unknown"], 1);
  EXPECT_THAT(channel_.faults(), IsEmpty());
  EXPECT_TRUE(channel_.is_open());
}

TEST(SlcanChannelConfigTest, ABitRateThatNoAdapterHasIsRefused) {
  EXPECT_THROW(SlcanChannel(333, {}), std::runtime_error);
}

}  // namespace
}  // namespace curbstone::encoder::can
