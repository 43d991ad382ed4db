// Faults of a CAN drive that last for the rest of the drive.
#include <cmath>

#include "tests/drivers/encoder/encoder_on_a_bus.hpp"

namespace curbstone::encoder {
namespace {

using can::CanFrame;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class LastingFaults : public EncoderOfADrive {
 protected:
  /// From now on the count of a wheel (both: 2) is what it was.
  void freeze(int side) {
    std::array<std::uint8_t, 8> at{};
    bool known = false;
    rig_.corrupt = [side, at, known](CanFrame& frame) mutable {
      if (frame.id != kPositions) return;
      if (!known) std::copy_n(frame.data.begin(), 8, at.begin());
      known = true;
      if (side != 1) std::copy_n(at.begin(), 4, frame.data.begin());
      if (side != 0) std::copy_n(at.begin() + 4, 4, frame.data.begin() + 4);
    };
  }
};

TEST_F(LastingFaults, ACountThatStandsStillIsFlaggedAndReportedAndTheOtherWheelGoesOn) {
  EXPECT_THAT(faults(), IsEmpty());
  freeze(1);
  rig_.run_for(30'000'000);
  EXPECT_THAT(faults(), Contains(HasSubstr("the count of the right wheel stands still")));
  const wheels_t& last = rig_.messages().back();
  EXPECT_EQ(last.faults[wheels_t::RIGHT], 0x0800);
  EXPECT_EQ(last.faults[wheels_t::LEFT], 0);
  EXPECT_FALSE(last.enabled);
  EXPECT_NEAR(last.speed[wheels_t::LEFT], 10, 0.4);
  rig_.corrupt = [](CanFrame&) {};
  rig_.run_for(3'000'000);
  EXPECT_THAT(faults(), IsEmpty());
}

TEST_F(LastingFaults, TheSamePositionsOverAndOverAreWithheld) {
  freeze(2);
  rig_.run_for(2'000'000);
  const std::size_t before = rig_.messages().size();
  rig_.run_for(30'000'000);
  EXPECT_EQ(rig_.messages().size(), before);
  EXPECT_GE(rig_.count("withheld.stuck"), 2900);
  EXPECT_THAT(faults(), Contains(HasSubstr("the count of the left wheel stands still")));
}

TEST_F(LastingFaults, PositionsThatStayAwayAreAFaultThoughAllElseComes) {
  rig_.lost = [](const CanFrame& frame) { return frame.id == kPositions; };
  const std::size_t before = rig_.messages().size();
  rig_.run_for(20'000'000);
  EXPECT_LE(rig_.messages().size(), before + 1);
  EXPECT_THAT(faults(), Contains(HasSubstr("no positions from the drive for")));
  EXPECT_GE(rig_.count("drive.silences"), 10);
  rig_.lost = [](const CanFrame&) { return false; };
  rig_.run_for(3'000'000);
  EXPECT_THAT(faults(), IsEmpty());
}

/// The bus is off, or its cable is: nothing comes, nothing gets through.
TEST_F(LastingFaults, ABusThatIsOffForAMinuteIsAFaultUntilItIsBackAndNoSpeedIsWrong) {
  rig_.connected = false;
  rig_.run_for(2'000'000);
  for (int second = 0; second < 60; ++second) {
    rig_.run_for(1'000'000);
    ASSERT_THAT(faults(), Contains(HasSubstr("no positions from the drive for"))) << second;
  }
  const std::size_t before = rig_.messages().size();
  rig_.connected = true;
  rig_.run_for(5'000'000);
  EXPECT_THAT(faults(), IsEmpty());
  EXPECT_GT(rig_.messages().size(), before + 250);
  for (std::size_t i = before; i < rig_.messages().size(); ++i) {
    const double speed = rig_.messages()[i].speed[0];
    EXPECT_TRUE(std::abs(speed - 10) < 0.8 || speed == 0) << speed;  // the first one has none
  }
}

TEST_F(LastingFaults, ADriveThatRestartsEachThreeSecondsIsReportedAndNoSpeedIsWrong) {
  std::size_t checked = rig_.messages().size();
  for (int restart = 0; restart < 10; ++restart) {
    rig_.first_count -= rig_.raw(rig_.now, 0);
    rig_.receive(rig_.now, rig_.drive.power_on(rig_.now));
    rig_.drive.set_speeds(955, -955);
    rig_.run_for(3'000'000);
  }
  EXPECT_THAT(faults(), Contains(HasSubstr("the drive has restarted 3 times within a minute")));
  EXPECT_EQ(rig_.count("drive.boots"), 11);
  EXPECT_GT(rig_.messages().size(), checked + 2000);
  for (; checked < rig_.messages().size(); ++checked) {
    const double speed = rig_.messages()[checked].speed[0];
    EXPECT_TRUE(std::abs(speed - 10) < 0.8 || speed == 0) << speed;  // the first one after a restart has none
  }
  rig_.run_for(61'000'000);
  EXPECT_THAT(faults(), IsEmpty());
}

/// Another device than the configuration says, or one whose timer has another unit.
class AnyPeriod : public EncoderThatListens, public ::testing::WithParamInterface<int> {};

TEST_P(AnyPeriod, IsFoundBeforeASampleGoesOutAndNoneIsWithheld) {
  send(10, GetParam());
  rig_.node.finish();
  const auto sent = static_cast<std::size_t>(std::ceil(10e6 / GetParam()));
  ASSERT_EQ(rig_.messages().size(), sent) << counters();
  for (std::size_t i = 0; i < sent; ++i) {
    const std::int64_t taken = test::DriveRig::kStart + static_cast<std::int64_t>(i) * GetParam();
    ASSERT_NEAR(static_cast<double>(rig_.messages()[i].utime - taken), 250, 250) << i << "\n" << counters();
  }
  expect_true_messages(0.8);
  EXPECT_EQ(rig_.count("lost.samples"), 0);
  EXPECT_THAT(faults(), Contains(HasSubstr("the drive sends every")));
}
INSTANTIATE_TEST_SUITE_P(Us, AnyPeriod,
                         ::testing::Values(2'500, 5'000, 7'000, 8'000, 9'000, 11'000, 12'500, 15'000, 20'000, 50'000));

}  // namespace
}  // namespace curbstone::encoder
