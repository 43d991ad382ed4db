#include "drivers/encoder/encoder_node.hpp"

#include <gmock/gmock.h>

#include <random>

#include "tests/drivers/byte_stream.hpp"
#include "tests/drivers/encoder/drive_rig.hpp"

namespace curbstone::encoder {
namespace {

using test::DriveRig;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(EncoderNodeTest, SetsUpADriveAndPublishesWheelsThatGoForward) {
  test::DriveRig rig;
  rig.receive(rig.now, rig.drive.power_on(rig.now));
  rig.drive.set_enabled(true);
  rig.run_for(3'000'000);
  ASSERT_GT(rig.messages().size(), 280u);
  EXPECT_THAT(rig.node.report().faults, IsEmpty());
  EXPECT_EQ(rig.count("lost.samples"), 0);
  const wheels_t& last = rig.messages().back();
  EXPECT_TRUE(last.enabled);
  for (int side = 0; side < 2; ++side) {
    EXPECT_NEAR(last.speed[side], 10, 2 * 0.16);  // a count in 10 ms
    EXPECT_NEAR(last.angle[side], rig.angle(last.utime) - rig.angle(rig.messages().front().utime), 0.01);
  }
  for (std::size_t i = 1; i < rig.messages().size(); ++i) {
    EXPECT_EQ(rig.messages()[i].sequence, rig.messages()[i - 1].sequence + 1);
    EXPECT_NEAR(static_cast<double>(rig.messages()[i].utime - rig.messages()[i - 1].utime), 10'000, 1);
  }
}

TEST(EncoderNodeTest, CountsAreUnwrappedAcrossInt32) {
  test::DriveRig rig;
  rig.first_count = 0x7FFFFFFF - 2000;
  rig.receive(rig.now, rig.drive.power_on(rig.now));
  rig.run_for(3'000'000);
  EXPECT_EQ(rig.count("refused.jump"), 0);
  EXPECT_GT(rig.messages().back().counts[0], 15'000);
  EXPECT_GT(rig.messages().back().counts[1], 15'000);
}

TEST(EncoderNodeTest, JitterAndBunchesDoNotReachTheStampsOrTheSpeeds) {
  test::DriveRig rig;
  std::mt19937 random(5);
  rig.receive(rig.now, rig.drive.power_on(rig.now));
  rig.run_for(1'000'000);
  const std::size_t settled = rig.messages().size();
  rig.delay = [&](const can::CanFrame&) -> std::int64_t {
    return random() % 20 == 0 ? 5'000 + static_cast<std::int64_t>(random() % 40'000)
                              : static_cast<std::int64_t>(random() % 2'000);
  };
  rig.run_for(10'000'000);
  const std::int64_t phase = rig.messages()[settled - 1].utime % 10'000;
  double worst_stamp = 0;
  double worst_speed = 0;
  for (std::size_t i = settled; i < rig.messages().size(); ++i) {
    const wheels_t& m = rig.messages()[i];
    worst_stamp = std::max(worst_stamp, std::abs(static_cast<double>((m.utime - phase + 5'000) % 10'000 - 5'000)));
    worst_speed = std::max(worst_speed, std::abs(m.speed[0] - 10));
    // Where the wheel was when the stamp says: the stamp may be off by no more than the least delay varies.
    EXPECT_NEAR(m.angle[0], rig.angle(m.utime) - rig.angle(rig.messages()[0].utime), 10 * 0.002) << i;
  }
  EXPECT_LE(worst_speed, 0.32);
  EXPECT_LE(worst_stamp, 400);
  EXPECT_EQ(rig.count("lost.samples"), 0);
}

TEST(EncoderNodeTest, LostSamplesAreCountedAndDoNotDoubleTheSpeed) {
  test::DriveRig rig;
  std::mt19937 random(6);
  rig.receive(rig.now, rig.drive.power_on(rig.now));
  rig.run_for(1'000'000);
  int lost = 0;
  rig.delay = [&](const can::CanFrame&) { return static_cast<std::int64_t>(random() % 1'500); };
  rig.lost = [&](const can::CanFrame& frame) {
    const bool lose = frame.id == 0x181 && random() % 20 == 0;
    lost += lose;
    return lose;
  };
  rig.run_for(10'000'000);
  ASSERT_GT(lost, 30);
  EXPECT_EQ(rig.count("lost.samples"), lost);
  for (std::size_t i = 20; i < rig.messages().size(); ++i) EXPECT_NEAR(rig.messages()[i].speed[0], 10, 0.4) << i;
}

TEST(EncoderNodeTest, AFrameThatComesTwiceIsUsedOnceAndMovesNoStamp) {
  test::DriveRig rig;
  rig.run_for(2'000'000);
  const std::size_t before = rig.messages().size();
  int positions = 0;
  rig.copies = [&](const can::CanFrame& frame) { return frame.id == 0x181 && ++positions % 7 == 0 ? 2 : 1; };
  rig.run_for(5'000'000);
  EXPECT_EQ(rig.count("refused.repeated"), positions / 7);
  EXPECT_EQ(rig.messages().size() - before, static_cast<std::size_t>(positions));
  EXPECT_EQ(rig.count("lost.samples"), 0);
  for (std::size_t i = before; i < rig.messages().size(); ++i) {
    EXPECT_EQ(rig.messages()[i].utime - rig.messages()[i - 1].utime, 10'000);
  }
}

TEST(EncoderNodeTest, ABusyHostLosesNothingWhateverTheWheelsDo) {
  for (const double speed : {0.0, 0.5, 10.0}) {
    test::DriveRig rig;
    std::mt19937 random(8);
    rig.speed = speed;
    rig.receive(rig.now, rig.drive.power_on(rig.now));
    rig.run_for(1'000'000);
    std::int64_t base = 200;
    rig.delay = [&](const can::CanFrame&) { return base + static_cast<std::int64_t>(random() % 6'000); };
    for (int busy = 0; busy < 6; ++busy) {  // now and then, for most of a second, nothing is served in time
      base = 9'000 + static_cast<std::int64_t>(random() % 20'000);
      rig.run_for(800'000);
      base = 200;
      rig.run_for(1'500'000);
    }
    EXPECT_EQ(rig.count("lost.samples"), 0) << speed;
    EXPECT_NEAR(static_cast<double>(rig.messages().size()), 1480, 25) << speed;
  }
}

TEST(EncoderNodeTest, AHostThatIsLateForGoodWhileDrivingLosesNothing) {
  test::DriveRig rig;
  rig.receive(rig.now, rig.drive.power_on(rig.now));
  rig.run_for(1'000'000);
  rig.delay = [](const can::CanFrame&) { return std::int64_t{9'500}; };
  rig.run_for(6'000'000);
  EXPECT_EQ(rig.count("lost.samples"), 0);
}

TEST(EncoderNodeTest, AHostThatSleptReadsWhatItMissedAtItsOwnTimes) {
  test::DriveRig rig;
  rig.receive(rig.now, rig.drive.power_on(rig.now));
  rig.run_for(1'000'000);
  rig.sleep_for(900'000);
  rig.run_for(2'000'000);
  EXPECT_EQ(rig.count("lost.samples"), 0);
  EXPECT_EQ(rig.count("dropped.not_newer"), 0);
  EXPECT_EQ(rig.count("drive.silences"), 0);
  for (std::size_t i = 1; i < rig.messages().size(); ++i) {
    const wheels_t& m = rig.messages()[i];
    EXPECT_NEAR(static_cast<double>(m.utime - rig.messages()[i - 1].utime), 10'000, 250) << i;
    EXPECT_NEAR(m.angle[0], rig.angle(m.utime) - rig.angle(rig.messages()[0].utime), 10 * 0.001) << i;
  }
}

TEST(EncoderNodeTest, WhatCameInABunchBeforeTheFirstPunctualSampleIsNotLost) {
  for (const std::int64_t busy : {0, 8'000, 25'000, 70'000, 180'000}) {  // us that the host is at first
    EncoderConfig config;
    config.configure = false;
    test::Recorder<wheels_t> recorder("WHEELS");
    EncoderNode node(config, recorder.bus());
    std::mt19937 random(4);
    for (int i = 0; i < 100; ++i) {
      const std::int64_t late = 200 + static_cast<std::int64_t>(random() % 2'000);
      const std::int64_t received = test::DriveRig::kStart + std::max(busy, 10'000 * i + late);
      const auto count = static_cast<std::uint16_t>(40 * i);
      const auto low = static_cast<std::uint8_t>(count), high = static_cast<std::uint8_t>(count >> 8);
      node.on_frame(received, can::CanFrame::make(0x181, {low, high, 0, 0, low, high, 0, 0}));
    }
    EXPECT_EQ(node.report().counters["dropped.not_newer"], 0) << busy;
    EXPECT_EQ(node.report().counters["lost.samples"], 0) << busy;
    ASSERT_EQ(recorder.messages().size(), 100u) << busy;
    for (int i = 0; i < 100; ++i) {
      const wheels_t& m = recorder.messages()[static_cast<std::size_t>(i)];
      EXPECT_EQ(m.sequence, i);
      EXPECT_EQ(m.counts[0], 40 * i);
      EXPECT_NEAR(static_cast<double>(m.utime - test::DriveRig::kStart), 10'000.0 * i + 400, 400) << busy << ' ' << i;
    }
  }
}

TEST(EncoderNodeTest, LossesWhileStandingAreFoundInHindsight) {
  test::DriveRig rig;
  rig.speed = 0;
  rig.receive(rig.now, rig.drive.power_on(rig.now));
  rig.run_for(1'000'000);
  int lost = 0;
  rig.lost = [&](const can::CanFrame& frame) {
    const bool lose = frame.id == 0x181 && lost < 3;
    lost += lose;
    return lose;
  };
  rig.run_for(6'000'000);
  EXPECT_EQ(rig.count("lost.samples"), 3);
  EXPECT_NEAR(static_cast<double>(rig.now - rig.messages().back().utime), 0, 11'000);
}

TEST(EncoderNodeTest, ADriveThatRestartsIsSetUpAgainAndTheAngleGoesOn) {
  test::DriveRig rig;
  rig.receive(rig.now, rig.drive.power_on(rig.now));
  rig.run_for(1'000'000);
  const wheels_t before = rig.messages().back();
  rig.first_count -= rig.raw(rig.now, 0);  // it counts from about 0 again
  rig.receive(rig.now, rig.drive.power_on(rig.now));
  rig.run_for(1'000'000);
  EXPECT_EQ(rig.count("drive.boots"), 2);
  const wheels_t& after = rig.messages().back();
  EXPECT_GT(after.sequence, before.sequence + 80);
  EXPECT_NEAR(after.angle[0] - before.angle[0], 10, 0.8);  // less what it turned meanwhile
  EXPECT_EQ(rig.count("refused.jump"), 0);
}

TEST(EncoderNodeTest, ASilentDriveIsAFaultAndIsSetUpWhenItIsBack) {
  test::DriveRig rig;
  rig.receive(rig.now, rig.drive.power_on(rig.now));
  rig.run_for(1'000'000);
  rig.connected = false;
  rig.run_for(5'000'000);
  EXPECT_THAT(rig.node.report().faults, Contains(HasSubstr("no positions from the drive for 5 s")));
  EXPECT_THAT(rig.node.report().faults, Contains(HasSubstr("does not answer")));
  rig.drive.power_on(rig.now);  // its boot-up is missed
  rig.connected = true;
  const std::size_t before = rig.messages().size();
  rig.run_for(3'000'000);
  EXPECT_GT(rig.messages().size(), before + 100);
  EXPECT_THAT(rig.node.report().faults, IsEmpty());
}

TEST(EncoderNodeTest, AStopBySomebodyElseIsNoticed) {
  test::DriveRig rig;
  rig.receive(rig.now, rig.drive.power_on(rig.now));
  rig.run_for(2'000'000);
  rig.drive.on_frame(rig.now, canopen::nmt(canopen::NmtCommand::kPreOperational, 0));
  const std::size_t before = rig.messages().size();
  rig.run_for(1'000'000);
  EXPECT_GT(rig.messages().size(), before + 50);
}

TEST(EncoderNodeTest, FaultsOfTheDriveAreReportedByWheelAndByName) {
  test::DriveRig rig;
  rig.receive(rig.now, rig.drive.power_on(rig.now));
  rig.drive.set_enabled(true);
  rig.run_for(2'000'000);
  rig.receive(rig.now, rig.drive.set_faults(0, 0x0404));
  rig.run_for(300'000);
  EXPECT_THAT(rig.node.report().faults, Contains("drive, right wheel: over-current, motor temperature"));
  EXPECT_EQ(rig.messages().back().faults[1], 0x0404);
  EXPECT_FALSE(rig.messages().back().enabled);
  rig.receive(rig.now, rig.drive.set_faults(0, 0));
  rig.run_for(300'000);
  EXPECT_THAT(rig.node.report().faults, IsEmpty());
}

TEST(EncoderNodeTest, OneCorruptedSampleIsRefusedAndTheNextIsRight) {
  test::DriveRig rig;
  rig.receive(rig.now, rig.drive.power_on(rig.now));
  rig.run_for(1'000'000);
  const double angle = rig.messages().back().angle[0];
  rig.node.on_frame(rig.now, can::CanFrame::make(0x181, {0, 0, 0, 0x40, 0, 0, 0, 0}));
  rig.run_for(1'000'000);
  EXPECT_EQ(rig.count("refused.jump"), 1);
  EXPECT_NEAR(rig.messages().back().angle[0] - angle, 10, 0.2);
}

TEST(EncoderNodeTest, ASampleThatIsAPeriodLateAfterTwoCorruptOnesKeepsItsTime) {
  test::DriveRig rig;
  int positions = 0;
  rig.corrupt = [&](can::CanFrame& frame) {
    if (frame.id == 0x181 && (positions == 300 || positions == 301)) frame.data[3] ^= 0x40;
  };
  rig.delay = [&](const can::CanFrame& frame) -> std::int64_t {
    return frame.id == 0x181 && positions++ == 302 ? 10'300 : 200;
  };
  rig.receive(rig.now, rig.drive.power_on(rig.now));
  rig.run_for(5'000'000);
  EXPECT_EQ(rig.count("refused.jump"), 2);
  EXPECT_EQ(rig.count("lost.samples"), 0);
  ASSERT_GT(rig.messages().size(), 400u);
  for (const wheels_t& message : rig.messages()) {
    EXPECT_NEAR(message.angle[0], rig.angle(message.utime) - rig.angle(rig.messages()[0].utime), 10 * 0.001);
  }
}

TEST(EncoderNodeTest, ATimerInAnotherUnitIsReportedAndTheSpeedsStayRight) {
  test::DriveRig rig({}, {.event_timer_unit = 1000});  // by the standard: 20 ms, not 10
  rig.receive(rig.now, rig.drive.power_on(rig.now));
  rig.drive.on_frame(rig.now, {});
  rig.speed = 0;  // standing: only the event timer sends
  rig.run_for(5'000'000);
  EXPECT_THAT(rig.node.report().faults, Contains(HasSubstr("sends every 20.0 ms, 10 ms was asked for")));
}

TEST(EncoderNodeTest, ListensOnlyWhereAnotherMasterIsInCharge) {
  EncoderConfig config;
  config.configure = false;
  test::Recorder<wheels_t> recorder("WHEELS");
  int sent = 0;
  EncoderNode node(config, recorder.bus(), [&](const can::CanFrame&) { ++sent; });
  for (int i = 0; i < 200; ++i) {
    const std::int64_t now = test::DriveRig::kStart + i * 10'000;
    node.on_frame(now, can::CanFrame::make(0x181, {static_cast<std::uint8_t>(i), 0, 0, 0, 0, 0, 0, 0}));
    node.tick(now);
  }
  EXPECT_EQ(sent, 0);
  EXPECT_EQ(recorder.messages().size(), 200u);
}

TEST(EncoderNodeTest, ManyRefusedFramesAreAFaultThatNamesTheCause) {
  test::DriveRig rig;
  rig.receive(rig.now, rig.drive.power_on(rig.now));
  rig.run_for(2'000'000);
  for (int i = 0; i < 200; ++i) {
    rig.run_for(10'000);
    if (i % 5 == 0) rig.node.on_frame(rig.now, can::CanFrame::make(0x181, {1, 2, 3}));
  }
  EXPECT_THAT(rig.node.report().faults, Contains(HasSubstr("most of them refused.length")));
  rig.run_for(3'000'000);
  EXPECT_THAT(rig.node.report().faults, IsEmpty());
  for (int i = 0; i < 200; ++i) {
    rig.run_for(10'000);
    if (i % 5 == 0) rig.node.on_refused(rig.now, "refused.slcan_line");
  }
  EXPECT_THAT(rig.node.report().faults, Contains(HasSubstr("most of them refused.slcan_line")));
}

TEST(EncoderNodeTest, FramesOfEveryShapeAreSurvivedAndTheDriveIsReadOn) {
  test::DriveRig rig;
  std::mt19937 random(9);
  rig.receive(rig.now, rig.drive.power_on(rig.now));
  rig.run_for(1'000'000);
  const auto ids = canopen::WheelDrive::ids(1);
  for (int i = 0; i < 20'000; ++i) {
    can::CanFrame frame;
    frame.id = random() % 3 == 0 ? static_cast<std::uint32_t>(random() % 0x800) : ids[random() % ids.size()];
    frame.extended = random() % 8 == 0;
    frame.remote = random() % 8 == 0;
    frame.size = static_cast<std::uint8_t>(random() % 9);
    for (auto& byte : frame.data) byte = static_cast<std::uint8_t>(random());
    rig.node.on_frame(rig.now, frame);
    if (i % 100 == 0) rig.run_for(10'000);
  }
  rig.run_for(5'000'000);
  const std::size_t before = rig.messages().size();
  rig.run_for(1'000'000);
  EXPECT_GT(rig.messages().size(), before + 90);
  EXPECT_NEAR(rig.messages().back().speed[0], 10, 0.4);
  EXPECT_GT(rig.count("refused.length"), 0);
}

}  // namespace
}  // namespace curbstone::encoder
