#include "drivers/encoder/modbus/drive_poll.hpp"

#include <gmock/gmock.h>

#include <deque>
#include <vector>

namespace curbstone::encoder::modbus {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::uint16_t kFaultBits = 0x0404;

/// Answers each request as set, else well.
struct Line {
  Reply read(const Block& block, std::span<std::uint16_t> registers) {
    asked.push_back(block.count);
    ++utime;
    Reply reply{Outcome::kOk, 0, utime, utime, 4'000};
    if (!next.empty()) {
      reply.outcome = next.front();
      next.pop_front();
    }
    if (block.count > most && reply.outcome == Outcome::kOk) {
      reply.outcome = Outcome::kException;
      reply.exception = 2;
    }
    if (reply.outcome != Outcome::kOk) return reply;
    for (int i = 0; i < block.count; ++i) registers[static_cast<std::size_t>(i)] = value(block.address + i);
    return reply;
  }
  static std::uint16_t value(int address) {
    switch (address) {
      case 0x2030:
        return 1024;
      case 0x20A2:
        return 0x4141;
      case 0x20A6:
        return kFaultBits;
      case 0x20A8:
        return 1234;
      case 0x20A9:
        return 0xFFFF;
      case 0x20AA:
        return 0xFFFE;
      default:
        return 0;
    }
  }
  std::vector<int> asked;  // counts
  std::deque<Outcome> next;
  int most = 125;
  std::int64_t utime = 1000;
};

class DrivePollTest : public ::testing::Test {
 protected:
  void poll(int times = 1) {
    for (int i = 0; i < times; ++i) {
      line_.asked.clear();
      poll_.poll([this](const Reading& reading) { readings_.push_back(reading); });
    }
  }
  Line line_;
  DrivePoll poll_{[this](const Block& block, auto registers) { return line_.read(block, registers); }, [] {}};
  std::vector<Reading> readings_;
};

TEST_F(DrivePollTest, OneBlockAPollCarriesPositionsAndFaults) {
  poll(2);
  EXPECT_THAT(line_.asked, ElementsAre(8));
  ASSERT_EQ(readings_.size(), 2u);
  EXPECT_EQ(readings_[1].counts, (std::array<std::int32_t, 2>{1234, -2}));
  EXPECT_EQ(readings_[1].faults, (std::array<std::uint16_t, 2>{0, kFaultBits}));
  EXPECT_EQ(readings_[1].encoder_lines, 1024u);
  EXPECT_THAT(poll_.fault(), IsEmpty());
}

TEST_F(DrivePollTest, TheStatusIsReadInEachTenthPoll) {
  poll();
  int status = 0;
  for (int i = 0; i < 100; ++i) {
    poll();
    status += static_cast<int>(std::ranges::count(line_.asked, 1));
  }
  EXPECT_EQ(status, 10);
  EXPECT_TRUE(readings_.back().state.enabled);
}

TEST_F(DrivePollTest, ADriveThatKnowsNoLargeBlockIsReadBySmallerOnesAndItsFaultsAreStillKnown) {
  for (const int most : {6, 4}) {
    line_.most = most;
    poll_.restart();
    readings_.clear();
    poll(30);
    ASSERT_GT(readings_.size(), 25u) << most;
    EXPECT_EQ(readings_.back().counts[0], 1234);
    EXPECT_EQ(readings_.back().faults[1], kFaultBits);
    EXPECT_GT(readings_.back().faults_time, 0);
  }
  EXPECT_EQ(poll_.counters()["modbus.fallbacks"], 1 + 2);
}

TEST_F(DrivePollTest, AfterAnErrorPositionsAreReadOnlyWhenAReplyOfAnotherLengthHasCome) {
  poll(2);
  for (const Outcome error : {Outcome::kTimeout, Outcome::kCrc, Outcome::kWrongSlave, Outcome::kMalformed}) {
    const std::size_t before = readings_.size();
    line_.next = {error};
    poll();
    EXPECT_EQ(readings_.size(), before);
    line_.next = {Outcome::kMalformed};  // the late reply to the block
    poll();
    EXPECT_THAT(line_.asked, ElementsAre(3));
    EXPECT_EQ(readings_.size(), before);
    poll();
    EXPECT_THAT(line_.asked, ElementsAre(3, 8));
    EXPECT_EQ(readings_.size(), before + 1);
  }
}

TEST_F(DrivePollTest, EachCauseHasItsCounter) {
  poll(2);
  line_.next = {Outcome::kTimeout, Outcome::kCrc,  Outcome::kWrongSlave, Outcome::kMalformed,
                Outcome::kUnasked, Outcome::kSlow, Outcome::kException};
  poll(10);
  for (const char* cause : {"timeout", "crc", "wrong_slave", "malformed", "unasked", "slow", "exception"})
    EXPECT_EQ(poll_.counters()[std::string("refused.") + cause], 1) << cause;
}

TEST_F(DrivePollTest, AReplyThatCameTooLateIsNoReading) {
  poll(2);
  const std::size_t before = readings_.size();
  line_.next = {Outcome::kSlow};
  poll();
  EXPECT_EQ(readings_.size(), before);
}

TEST_F(DrivePollTest, FailuresInARowAreAFaultAndAskForThePortToBeOpenedAnew) {
  poll(2);
  EXPECT_FALSE(poll_.must_reopen());
  line_.next.assign(DrivePoll::kMaxFailures, Outcome::kTimeout);
  poll(DrivePoll::kMaxFailures);
  EXPECT_TRUE(poll_.must_reopen());
  EXPECT_THAT(poll_.fault(), HasSubstr("does not answer"));
  poll_.restart();
  poll();
  EXPECT_FALSE(poll_.must_reopen());
  EXPECT_THAT(poll_.fault(), IsEmpty());
}

TEST_F(DrivePollTest, APortThatIsGoneIsToBeOpenedAtOnce) {
  poll(2);
  line_.next = {Outcome::kGone};
  poll();
  EXPECT_TRUE(poll_.must_reopen());
}

}  // namespace
}  // namespace curbstone::encoder::modbus
