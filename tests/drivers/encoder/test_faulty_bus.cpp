// Faults of a bus and of what else is on it, in the frames of an emulated drive: what is bad costs itself.
#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "tests/drivers/encoder/encoder_on_a_bus.hpp"

namespace curbstone::encoder {
namespace {

using can::CanFrame;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

CanFrame counts_frame(std::int32_t left, std::int32_t right) {
  CanFrame frame = CanFrame::make(kPositions, {0, 0, 0, 0, 0, 0, 0, 0});
  for (std::size_t byte = 0; byte < 4; ++byte) {
    frame.data[byte] = static_cast<std::uint8_t>(static_cast<std::uint32_t>(left) >> (8 * byte));
    frame.data[4 + byte] = static_cast<std::uint8_t>(static_cast<std::uint32_t>(right) >> (8 * byte));
  }
  return frame;
}

class FaultyBus : public EncoderOfADrive {};

TEST_F(FaultyBus, FramesOfAnotherLengthAreRefusedAndTheirSamplesCountAsLost) {
  int position = 0, cut = 0;
  rig_.corrupt = [&](CanFrame& frame) {
    if (frame.id != kPositions || ++position % 10 != 0) return;
    frame.size = static_cast<std::uint8_t>(cut++ % 8);
  };
  rig_.run_for(5'000'000);
  rig_.corrupt = [](CanFrame&) {};
  rig_.run_for(100'000);
  EXPECT_EQ(rig_.count("refused.length"), cut);
  EXPECT_EQ(rig_.count("lost.samples"), cut);
  expect_true_messages();
}

TEST_F(FaultyBus, RemoteAndExtendedFramesWithOurIdsAreNotOurs) {
  for (int i = 0; i < 100; ++i) {
    rig_.run_for(30'000);
    for (const std::uint32_t id : {0x181U, 0x281U, 0x581U, 0x701U, 0x081U}) {
      CanFrame frame = CanFrame::make(id, {0, 0, 0, 0, 0, 0, 0, 0});
      if (id == 0x701U) frame.size = 1;
      (i % 2 == 0 ? frame.remote : frame.extended) = true;
      rig_.node.on_frame(rig_.now, frame);
    }
  }
  EXPECT_EQ(rig_.count("ignored.frames"), 500);
  EXPECT_EQ(rig_.count("drive.boots"), 1);
  EXPECT_EQ(rig_.count("lost.samples"), 0);
  expect_true_messages();
}

TEST_F(FaultyBus, ASecondNodeWithOurIdIsRefusedAndMovesNoStamp) {
  int foreign = 0;
  const std::size_t fresh = [&] {
    const std::size_t before = rig_.messages().size();
    for (int i = 0; i < 300; ++i) {
      rig_.run_for(10'000);
      rig_.node.on_frame(rig_.now,
                         CanFrame::make(kPositions, {1, 2, 3, 4, static_cast<std::uint8_t>(foreign++), 0, 0, 0}));
    }
    return rig_.messages().size() - before;
  }();
  EXPECT_GE(fresh, 295U) << counters();
  EXPECT_EQ(rig_.count("refused.jump"), foreign) << counters();
  EXPECT_EQ(rig_.count("counts_restarted"), 0);
  EXPECT_THAT(faults(), Contains(HasSubstr("most of them refused.jump")));
  expect_true_messages();
}

/// Two drives that are switched on together count alike at first: the counts of both can be, by turns, and 5 to 55
/// rad/s were made of them. Nobody knows which is ours.
TEST(TwoDrivesWithOneId, AreNamedAndNeitherIsUsedUntilOneIsOff) {
  for (const std::int64_t after : {100, 2000, 5000, 8000, 9900}) {
    for (const std::int64_t apart : {0, 100, -300}) {
      SCOPED_TRACE(std::to_string(after) + " us after, counts apart: " + std::to_string(apart));
      test::DriveRig rig;
      rig.speed = 1.0;
      rig.receive(rig.now, rig.drive.power_on(rig.now));
      rig.run_for(1'000'000);
      const auto both = [&](int rounds) {
        for (int i = 0; i < rounds; ++i) {
          rig.run_for(after);
          rig.node.on_frame(rig.now, counts_frame(static_cast<std::int32_t>(apart), static_cast<std::int32_t>(apart)));
          rig.run_for(10'000 - after);
        }
      };
      rig.first_count -= rig.raw(rig.now, 0);  // ours counts from here; the other one stands
      rig.run_for(100'000);
      rig.first_count -= rig.raw(rig.now, 0);
      const std::size_t before = rig.messages().size();
      both(300);
      EXPECT_LE(rig.messages().size() - before, 6U);
      EXPECT_THAT(rig.node.report().faults, Contains(HasSubstr("another drive with CAN node id 1")));
      EXPECT_GT(rig.count("withheld.two_senders"), 580);
      const wheels_t last = rig.messages().back();
      rig.run_for(1'000'000);  // the other one is unplugged
      EXPECT_THAT(rig.node.report().faults, IsEmpty());
      EXPECT_GT(rig.messages().back().utime, last.utime + 3'900'000);
      EXPECT_NEAR(rig.messages().back().speed[0], 1.0, 0.2);
      EXPECT_NEAR(rig.messages().back().angle[0] - last.angle[0], 0.5, 0.6);  // what it drove meanwhile is not known
    }
  }
}

TEST_F(FaultyBus, PositionsThatAreSentTwiceMoveNoAngle) {
  for (int i = 0; i < 300; ++i) {
    rig_.run_for(10'000);
    if (i % 5 == 0) {  // a SYNC that came twice: the same drive, a moment later
      const std::int64_t at = rig_.now;
      rig_.node.on_frame(at, positions(at));
    }
  }
  EXPECT_EQ(rig_.count("lost.samples"), 0);
  expect_true_messages(100);
}

TEST_F(FaultyBus, CountsThatBeginAnewInMidDriveCostTheirDistanceOnly) {
  const wheels_t before = rig_.messages().back();
  rig_.first_count -= rig_.raw(rig_.now, 0) - 1'000'000;  // without a boot-up
  rig_.run_for(1'000'000);
  EXPECT_EQ(rig_.count("counts_restarted"), 1);
  EXPECT_EQ(rig_.count("refused.jump"), 2);
  EXPECT_NEAR(rig_.messages().back().angle[0] - before.angle[0], 10, 0.5);
  for (const wheels_t& message : rig_.messages()) ASSERT_LT(std::abs(message.speed[0]), 11) << counters();
}

TEST_F(FaultyBus, CountersWrapBothWays) {
  for (const double speed : {10.0, -10.0}) {
    test::DriveRig rig;
    rig.speed = speed;
    rig.first_count = speed > 0 ? 0x7FFFFFFF - 2000 : -0x7FFFFFFF + 2000;
    rig.receive(rig.now, rig.drive.power_on(rig.now));
    rig.run_for(3'000'000);
    EXPECT_EQ(rig.count("refused.jump") + rig.count("counts_restarted"), 0);
    EXPECT_NEAR(rig.messages().back().angle[0], 28 * speed / 10, 2.5);
    EXPECT_NEAR(rig.messages().back().angle[1], rig.messages().back().angle[0], 0.01);
  }
}

TEST_F(FaultyBus, RandomBitsInFramesNeverMoveAStamp) {
  std::mt19937 random(11);
  int damaged = 0;
  rig_.corrupt = [&](CanFrame& frame) {
    if (frame.id != kPositions || random() % 20 != 0) return;
    ++damaged;
    frame.data[2 + random() % 2] ^= static_cast<std::uint8_t>(1U << (random() % 7));  // 65536 counts and more
  };
  rig_.lost = [&](const CanFrame& frame) { return frame.id == kPositions && random() % 50 == 0; };
  rig_.delay = [&](const CanFrame&) -> std::int64_t {
    return 200 + (random() % 10 == 0 ? static_cast<std::int64_t>(random() % 25'000) : 0);
  };
  rig_.run_for(20'000'000);
  EXPECT_LE(rig_.count("refused.jump"), damaged);
  EXPECT_GE(rig_.count("refused.jump") + rig_.count("withheld.unsure"), damaged);
  EXPECT_GT(rig_.messages().size(), 1800U) << counters();
  expect_true_messages(0.6);
}

class AnotherPeriod : public EncoderThatListens {};

TEST_F(AnotherPeriod, ASyncOfAnotherRateMakesNoSpeedWrongAndIsReported) {
  for (const double period : {5'000.0, 2'500.0, 20'000.0}) {
    SCOPED_TRACE(period);
    send(3, 10'000);
    const std::size_t before = rig_.messages().size();
    send(5, period);
    EXPECT_GE(rig_.messages().size() - before, static_cast<std::size_t>(1.5e6 / period));
    EXPECT_THAT(faults(), Contains(HasSubstr("the drive sends every")));
    expect_true_messages(0.8);
    send(3, 10'000);
    expect_true_messages(0.8);
    EXPECT_THAT(faults(), ::testing::Not(Contains(HasSubstr("the drive sends every"))));
  }
}

TEST_F(AnotherPeriod, SamplesThatAreInterruptedBeforeTheirPeriodIsKnownAreWithheld) {
  send(0.1, 20'000);
  at_ += 1e6;
  send(5, 20'000);
  EXPECT_EQ(rig_.count("withheld.unsure"), 5);
  ASSERT_EQ(rig_.messages().size(), 250U) << counters();
  EXPECT_NEAR(seconds_of(rig_.messages().front()), 1.1, 0.001);
  expect_true_messages(0.8);
}

TEST_F(AnotherPeriod, AnotherPhaseCostsAFewSamples) {
  send(3, 10'000);
  for (const double earlier : {2'000.0, 4'900.0, 8'000.0}) {
    const std::size_t before = rig_.messages().size();
    at_ -= earlier;
    send(2, 10'000);
    EXPECT_GE(rig_.messages().size() - before, 194U) << earlier;
    EXPECT_EQ(rig_.count("lost.samples"), 0);
    expect_true_messages(0.8);
  }
}

TEST_F(AnotherPeriod, AWheelThatStandsAloneIsPublishedAsItIs) {
  send(3, 10'000);
  for (int i = 0; i < 300; ++i, at_ += 10'000) {
    CanFrame frame = positions(static_cast<std::int64_t>(at_));
    const CanFrame stuck = positions(static_cast<std::int64_t>(test::DriveRig::kStart) + 3'000'000);
    std::copy(stuck.data.begin() + 4, stuck.data.end(), frame.data.begin() + 4);
    rig_.node.on_frame(static_cast<std::int64_t>(at_) + 200, frame);
  }
  EXPECT_NEAR(rig_.messages().back().speed[0], 10, 0.4);
  EXPECT_EQ(rig_.messages().back().speed[1], 0);
  EXPECT_EQ(rig_.count("lost.samples"), 0);
}

}  // namespace
}  // namespace curbstone::encoder
