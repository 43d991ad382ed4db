#include "drivers/encoder/can/slcan_channel.hpp"

#include <gmock/gmock.h>

#include <stdexcept>

#include "tests/drivers/byte_stream.hpp"

namespace curbstone::encoder::can {
namespace {

using ::testing::ElementsAre;
using testing::from_text;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class SlcanChannelTest : public ::testing::Test {
 protected:
  /// What was sent since the last call.
  std::string sent() { return std::exchange(sent_, ""); }
  void answer(std::string_view text) { channel_.on_bytes(now_, testing::from_text(text)); }
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

TEST_F(SlcanChannelTest, ARefusalIsToldAndTriedAgain) {
  wait(0);
  wait(100'000);
  answer("\a\a");
  EXPECT_THAT(channel_.faults(), ElementsAre(HasSubstr("refuses to open")));
  sent();
  wait(1'000'000);
  EXPECT_EQ(sent(), "\r\rC\r");
}

TEST_F(SlcanChannelTest, ASilentAdapterIsToldAndOpenedAgain) {
  open();
  wait(900'000);
  EXPECT_EQ(sent(), "");
  wait(1'000'000);
  EXPECT_EQ(sent(), "F\r");
  wait(200'000);
  EXPECT_THAT(channel_.faults(), ElementsAre(HasSubstr("nothing from the SLCAN adapter")));
  EXPECT_EQ(sent(), "\r\rC\r");
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
