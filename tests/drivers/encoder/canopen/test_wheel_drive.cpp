#include "drivers/encoder/canopen/wheel_drive.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

#include "common/bytes/little_endian.hpp"
#include "tests/paths.hpp"

namespace curbstone::encoder::canopen {
namespace {

using canopen::Object;
using canopen::SdoCommand;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr std::uint32_t kRequest = 0x601;

/// A drive that answers every request at once, as the test says.
class WheelDriveTest : public ::testing::Test {
 protected:
  WheelDriveTest() : drive_(settings(), handlers()) {}

  static WheelDrive::Settings settings() {
    WheelDrive::Settings settings;
    settings.period = 20'000;
    return settings;
  }
  WheelDrive::Handlers handlers() {
    return {[this](const can::CanFrame& frame) { sent_.push_back(frame); },
            [this](std::int64_t, std::array<std::int32_t, 2> counts) { counts_.push_back(counts); },
            [this] { ++restarts_; }};
  }
  void accept_everything(std::int64_t now) {
    for (std::size_t i = 0; i < sent_.size(); ++i) {  // each answer brings the next request
      if (sent_[i].id != kRequest || i < answered_) continue;
      answered_ = i + 1;
      drive_.on_frame(
          now, can::CanFrame::make(0x581, {0x60, sent_[i].data[1], sent_[i].data[2], sent_[i].data[3], 0, 0, 0, 0}));
    }
  }
  void answer_last(std::int64_t now, SdoCommand command, std::uint32_t value) {
    const can::CanFrame& last = sent_.back();
    drive_.on_frame(
        now, canopen::sdo(0x581, command, {read_little_endian<std::uint16_t>(last.bytes().subspan(1)), last.data[3]},
                          value));
  }

  std::vector<can::CanFrame> sent_;
  std::size_t answered_ = 0;
  std::vector<std::array<std::int32_t, 2>> counts_;
  int restarts_ = 0;
  WheelDrive drive_;
};

TEST_F(WheelDriveTest, SetUpIsTheSequenceOfTheVendorsManual) {
  drive_.tick(0);
  accept_everything(1000);
  ASSERT_GE(sent_.size(), 9u);
  EXPECT_EQ(sent_[0], can::CanFrame::make(0x000, {0x80, 0x01}));
  EXPECT_EQ(sent_[1], can::CanFrame::make(kRequest, {0x2F, 0x00, 0x1A, 0x00, 0, 0, 0, 0}));
  EXPECT_EQ(sent_[2], can::CanFrame::make(kRequest, {0x23, 0x00, 0x1A, 0x01, 0x20, 0x01, 0x64, 0x60}));
  EXPECT_EQ(sent_[3], can::CanFrame::make(kRequest, {0x23, 0x00, 0x1A, 0x02, 0x20, 0x02, 0x64, 0x60}));
  EXPECT_EQ(sent_[4], can::CanFrame::make(kRequest, {0x2F, 0x00, 0x18, 0x02, 0xFF, 0, 0, 0}));
  EXPECT_EQ(sent_[5], can::CanFrame::make(kRequest, {0x2B, 0x00, 0x18, 0x03, 0xC8, 0x00, 0, 0}));  // 200 x 100 us
  EXPECT_EQ(sent_[6], can::CanFrame::make(kRequest, {0x2B, 0x00, 0x18, 0x05, 0x28, 0x00, 0, 0}));  // 40 x 500 us
  EXPECT_EQ(sent_[7], can::CanFrame::make(kRequest, {0x2F, 0x00, 0x1A, 0x00, 0x02, 0, 0, 0}));
  EXPECT_EQ(sent_.back(), can::CanFrame::make(0x000, {0x01, 0x01}));
}

TEST_F(WheelDriveTest, PositionsAreTwoLittleEndianInt32OnceTheDriveIsSetUp) {
  const can::CanFrame positions = can::CanFrame::make(0x181, {0x2E, 0xFB, 0xFF, 0xFF, 0x2E, 0x16, 0x00, 0x00});
  drive_.on_frame(0, positions);  // of an older set-up
  EXPECT_TRUE(counts_.empty());
  accept_everything(1000);
  drive_.on_frame(2000, positions);
  drive_.on_frame(2100, positions);  // the answer to the start, twice
  EXPECT_TRUE(counts_.empty());
  drive_.on_frame(22'000, positions);
  EXPECT_THAT(counts_, ElementsAre(std::array<std::int32_t, 2>{-1234, 5678}));
}

TEST_F(WheelDriveTest, ThePositionsThatAnswerTheStartAreNotOnTheBeatAndLeftOut) {
  drive_.tick(0);
  accept_everything(1000);
  const auto positions = [&](std::int64_t utime, std::uint8_t count) {
    drive_.on_frame(utime, can::CanFrame::make(0x181, {count, 0, 0, 0, 0, 0, 0, 0}));
  };
  positions(1100, 1);
  EXPECT_THAT(counts_, IsEmpty());
  EXPECT_EQ(drive_.counters()["ignored.first"], 1);
  positions(29'000, 2);
  positions(49'000, 3);
  EXPECT_EQ(counts_.size(), 2u);
  for (std::int64_t now = 100'000; now < 700'000; now += 100'000) drive_.tick(now);  // silence: it is set up again
  accept_everything(700'000);
  positions(700'100, 4);
  positions(729'000, 5);
  EXPECT_EQ(counts_.size(), 3u);
  EXPECT_EQ(drive_.counters()["ignored.first"], 2);
}

TEST_F(WheelDriveTest, ARefusedObjectIsNamedWithItsAbortCodeAndTriedAgainLater) {
  drive_.tick(0);
  answer_last(1000, SdoCommand::kAbort, 0x06040041);
  EXPECT_THAT(drive_.faults(), Contains(HasSubstr("refuses object 1A00:00: abort 06040041")));
  const std::size_t before = sent_.size();
  drive_.tick(500'000);
  EXPECT_EQ(sent_.size(), before);
  drive_.tick(1'100'000);
  EXPECT_GT(sent_.size(), before);
}

TEST_F(WheelDriveTest, ADriveWithoutAHeartbeatIsStillUsed) {
  drive_.tick(0);
  while (sent_.back().id == kRequest) {
    const bool heartbeat = sent_.back().data[1] == 0x17 && sent_.back().data[2] == 0x10;
    answer_last(1000, heartbeat ? SdoCommand::kAbort : SdoCommand::kWriteReply, heartbeat ? 0x06020000 : 0);
  }
  EXPECT_EQ(sent_.back(), can::CanFrame::make(0x000, {0x01, 0x01}));
  EXPECT_THAT(drive_.faults(), IsEmpty());
}

TEST_F(WheelDriveTest, ABootUpStartsOverAndDropsThePendingRequest) {
  drive_.tick(0);
  sent_.clear();
  drive_.on_frame(1000, can::CanFrame::make(0x701, {0x00}));
  EXPECT_EQ(restarts_, 1);
  ASSERT_EQ(sent_.size(), 2u);
  EXPECT_EQ(sent_[0], can::CanFrame::make(0x000, {0x80, 0x01}));
}

/// A drive that another master has set up, heard for a while from 1 s on.
class ListeningTest : public ::testing::Test {
 protected:
  ListeningTest() { drive_.tick(now_); }
  void receive(const can::CanFrame& frame) { drive_.on_frame(now_, frame); }
  void positions() { receive(can::CanFrame::make(0x181, {0, 0, 0, 0, 0, 0, 0, 0})); }
  void status(std::uint8_t low = 0x27) { receive(can::CanFrame::make(0x281, {low, 0, low, 0, 0, 0, 0, 0})); }
  void heartbeat(std::uint8_t state = 0x05) { receive(can::CanFrame::make(0x701, {state})); }
  void wait(std::int64_t us, bool with_status = true, bool with_heartbeat = true) {
    for (const std::int64_t end = now_ + us; now_ < end;) {
      now_ += 100'000;
      positions();
      if (with_status) status();
      if (with_heartbeat) heartbeat();
      drive_.tick(now_);
    }
  }

  std::int64_t now_ = 1'000'000;
  int sent_ = 0;
  WheelDrive drive_{{.configure = false}, {[this](const can::CanFrame&) { ++sent_; }, [](auto, auto) {}, [] {}}};
};

TEST_F(ListeningTest, ADriveThatSaysAllIsWellHasNoFault) {
  wait(10'000'000);
  EXPECT_THAT(drive_.faults(), IsEmpty());
  EXPECT_TRUE(drive_.status().enabled(now_));
  EXPECT_EQ(sent_, 0);
}

TEST_F(ListeningTest, AnEmergencyIsAFaultUntilTheDriveTakesItBack) {
  wait(1'000'000);
  receive(can::CanFrame::make(0x081, {0x10, 0x32, 0x04, 0, 0, 0, 0, 0}));
  EXPECT_THAT(drive_.faults(), ElementsAre("drive: emergency 3210, error register 04"));
  EXPECT_FALSE(drive_.status().enabled(now_));
  wait(5'000'000);
  EXPECT_THAT(drive_.faults(), ElementsAre(HasSubstr("emergency 3210")));
  receive(can::CanFrame::make(0x081, {0, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_THAT(drive_.faults(), IsEmpty());
  EXPECT_EQ(drive_.counters()["drive.emergencies"], 1);
}

TEST_F(ListeningTest, AStatusThatNeverCameOrIsOldIsAFaultAndNotAGoodOne) {
  wait(4'000'000, false);
  EXPECT_THAT(drive_.faults(), ElementsAre("the drive's status is not known for 4 s"));
  EXPECT_FALSE(drive_.status().enabled(now_));
  wait(1'000'000);
  EXPECT_THAT(drive_.faults(), IsEmpty());
  wait(3'000'000, false);
  EXPECT_THAT(drive_.faults(), ElementsAre("the drive's status is not known for 3 s"));
  EXPECT_FALSE(drive_.status().enabled(now_));
}

TEST_F(ListeningTest, AHeartbeatThatStopsIsAFaultOneThatNeverCameIsNot) {
  wait(5'000'000, true, false);
  EXPECT_THAT(drive_.faults(), IsEmpty());
  wait(1'000'000);
  wait(4'000'000, true, false);
  EXPECT_THAT(drive_.faults(), ElementsAre("the drive's heartbeat stays away for 4 s"));
  wait(100'000);
  EXPECT_THAT(drive_.faults(), IsEmpty());
}

/// A boot-up says that the drive was switched on, and nothing of heartbeats.
TEST_F(ListeningTest, ABootUpOfADriveWithoutHeartbeatsIsNoneThatStopped) {
  wait(5'000'000, true, false);
  heartbeat(0x00);
  wait(10'000'000, true, false);
  EXPECT_THAT(drive_.faults(), IsEmpty());
}

/// It was switched off and on while nobody heard it, or it is another one.
TEST_F(ListeningTest, AnEmergencyOfBeforeTheLinkWasLostIsNoneOfNow) {
  wait(1'000'000);
  receive(can::CanFrame::make(0x081, {0x10, 0x32, 0x04, 0, 0, 0, 0, 0}));
  now_ += 60'000'000;
  drive_.start(now_);
  wait(5'000'000);
  EXPECT_THAT(drive_.faults(), IsEmpty());
  EXPECT_TRUE(drive_.status().enabled(now_));
  for (int i = 0; i < 2; ++i) status(0xA8);
  EXPECT_THAT(drive_.faults(), Contains("drive, left wheel: alarm (status word 00A8)")) << "if it lasts this tells";
}

TEST_F(ListeningTest, ADriveThatAnotherMasterHasStoppedIsAFault) {
  wait(2'000'000);
  for (int i = 0; i < 2; ++i) heartbeat(0x7F);
  EXPECT_THAT(drive_.faults(), Contains("another master has made the drive pre-operational"));
  for (int i = 0; i < 2; ++i) heartbeat();
  EXPECT_THAT(drive_.faults(), Not(Contains(HasSubstr("pre-operational"))));
}

TEST_F(ListeningTest, AnAlarmInTheStatusWordIsAFaultThoughNobodyCanAskForItsCause) {
  wait(1'000'000);
  for (int i = 0; i < 2; ++i) status(0xA8);
  EXPECT_THAT(drive_.faults(), Contains("drive, left wheel: alarm (status word 00A8)"));
  EXPECT_THAT(drive_.faults(), Contains("drive, right wheel: alarm (status word 00A8)"));
  for (int i = 0; i < 2; ++i) status();
  EXPECT_THAT(drive_.faults(), IsEmpty());
}

TEST(DriveStatusTest, EnabledMeansBothWheelsPoweredAndNoFault) {
  DriveStatus status;
  EXPECT_FALSE(status.enabled(1000)) << "no status came";
  status.word_utime = 1000;
  status.word = {0x1427, 0x0027};
  EXPECT_TRUE(status.enabled(1000));
  EXPECT_FALSE(status.enabled(1000 + 3'000'000)) << "that was long ago";
  for (const int bits : {0x1421, 0x00A7, 0x0023, 0x0007, 0x002F, 0x0028}) {
    const auto word = static_cast<std::uint16_t>(bits);
    status.word = {0x0027, word};
    EXPECT_FALSE(status.enabled(1000)) << std::hex << word;
  }
  status.word = {0x0027, 0x0027};
  status.emergency = 0x1000;
  EXPECT_FALSE(status.enabled(1000));
  status.emergency = 0;
  status.faults = {0, 4};
  EXPECT_FALSE(status.enabled(1000));
}

class SdoClientTest : public ::testing::Test {
 protected:
  std::vector<can::CanFrame> sent_;
  std::vector<SdoClient::Result> results_;
  SdoClient client_{1, [this](const can::CanFrame& frame) { sent_.push_back(frame); }};
  SdoClient::Done keep_ = [this](std::int64_t, const SdoClient::Result& result) { results_.push_back(result); };
};

TEST_F(SdoClientTest, OnlyAReplyThatNamesTheObjectCounts) {
  client_.read(0, {0x603F, 0}, keep_);
  EXPECT_EQ(sent_[0], can::CanFrame::make(kRequest, {0x40, 0x3F, 0x60, 0x00, 0, 0, 0, 0}));
  client_.on_frame(1, can::CanFrame::make(0x581, {0x43, 0x3F, 0x60, 0x01, 9, 9, 9, 9}));  // other sub-index
  client_.on_frame(1, can::CanFrame::make(0x581, {0x43, 0x41, 0x60, 0x00, 9, 9, 9, 9}));  // other index
  client_.on_frame(1, can::CanFrame::make(0x581, {0x60, 0x3F, 0x60, 0x00, 0, 0, 0, 0}));  // of a write
  client_.on_frame(1, can::CanFrame::make(0x581, {0x41, 0x3F, 0x60, 0x00, 9, 0, 0, 0}));  // segmented
  client_.on_frame(1, can::CanFrame::make(0x581, {0x43, 0x3F, 0x60}));
  EXPECT_TRUE(results_.empty());
  client_.on_frame(2, can::CanFrame::make(0x581, {0x4B, 0x3F, 0x60, 0x00, 0x04, 0x01, 0xEE, 0xEE}));
  ASSERT_EQ(results_.size(), 1u);
  EXPECT_EQ(results_[0].value, 0x0104u);
  client_.on_frame(3, can::CanFrame::make(0x581, {0x4B, 0x3F, 0x60, 0x00, 0x04, 0x01, 0, 0}));  // once more, too late
  EXPECT_EQ(results_.size(), 1u);
  EXPECT_EQ(client_.counters()["ignored.sdo"], 6);
}

TEST_F(SdoClientTest, WhatDoesNotComeIsAbortedAskedAgainAndGivenUp) {
  client_.write(0, {0x1017, 0}, 2, 500, keep_);
  std::int64_t now = 0;
  for (; results_.empty() && now < 2'000'000; now += 20'000) client_.tick(now);
  EXPECT_EQ(now, SdoClient::kMaxTries * SdoClient::kAnswerTime + 20'000);
  ASSERT_EQ(results_.size(), 1u);
  EXPECT_EQ(results_[0].status, SdoClient::Result::Status::kNoAnswer);
  ASSERT_EQ(sent_.size(), 2u * SdoClient::kMaxTries);
  EXPECT_EQ(sent_[0], can::CanFrame::make(kRequest, {0x2B, 0x17, 0x10, 0x00, 0xF4, 0x01, 0, 0}));
  EXPECT_EQ(sent_[1], can::CanFrame::make(kRequest, {0x80, 0x17, 0x10, 0x00, 0x00, 0x00, 0x04, 0x05}));
  EXPECT_FALSE(client_.busy());
}

/// A line of a PCAN trace: "  6)       234.7  Rx         070A  1  RTR".
std::optional<can::CanFrame> parse_trace_line(const std::string& line) {
  std::istringstream in(line);
  std::string number;
  std::string direction;
  std::string id;
  double time = 0;
  int size = 0;
  if (line.empty() || line[0] == ';' || !(in >> number >> time >> direction >> id >> size) || direction != "Rx")
    return {};
  can::CanFrame frame;
  frame.id = static_cast<std::uint32_t>(std::stoul(id, nullptr, 16));
  frame.size = static_cast<std::uint8_t>(size);
  std::string byte;
  for (std::size_t i = 0; i < frame.size && in >> byte; ++i) {
    if (byte == "RTR") frame.remote = true;
    if (!frame.remote) frame.data[i] = static_cast<std::uint8_t>(std::stoul(byte, nullptr, 16));
  }
  return frame;
}

TEST_F(WheelDriveTest, ARealCanopenBusWithOtherDevicesIsListenedToWithoutHarm) {
  const std::string file = test::data_path("can/pcan2.trc");
  std::ifstream trace(file);
  if (!trace) GTEST_SKIP() << file << " is not there";
  int frames = 0;
  WheelDrive::Settings listen = settings();
  listen.node = 0x0F;  // a node of that bus; its first TPDO is 18F
  listen.configure = false;
  WheelDrive drive(listen, handlers());
  std::int64_t now = 0;
  for (std::string line; std::getline(trace, line);) {
    const auto frame = parse_trace_line(line);
    if (!frame) continue;
    ++frames;
    drive.on_frame(now += 100, *frame);
  }
  EXPECT_EQ(frames, 6968);
  EXPECT_TRUE(sent_.empty());
  EXPECT_GT(counts_.size(), 100u);
  EXPECT_GT(drive.counters()["ignored.frames"], 1000);
}

}  // namespace
}  // namespace curbstone::encoder::canopen
