#include "services/mapper/scan/odometry_history.hpp"

#include <gtest/gtest.h>

#include "services/mapper/scan/odometry_intake.hpp"
#include "tests/stamps.hpp"

namespace curbstone::mapper::scan {
namespace {

constexpr std::int64_t kPeriod = 10'000;
using test::kStart;

/// 5 m/s, turning left at 0.5 rad/s.
Pose on_a_circle(std::int64_t utime) {
  return move({Eigen::Vector3d(5, 0, 0), Eigen::Vector3d(0, 0, 0.5)}, 1e-6 * static_cast<double>(utime - kStart));
}

OdometrySample sample(int i, bool usable = true) {
  const std::int64_t utime = kStart + i * kPeriod;
  return {utime, on_a_circle(utime), usable, false};
}

OdometryHistory history_of(int num_samples) {
  OdometryHistory history;
  for (int i = 0; i < num_samples; ++i) EXPECT_EQ(history.add(sample(i)), OdometryHistory::Added::kYes);
  return history;
}

double apart(const Pose& a, const Pose& b) {
  return (a.translation() - b.translation()).norm();
}

TEST(OdometryHistory, InterpolatesBetweenSamples) {
  const OdometryHistory history = history_of(20);
  for (const std::int64_t t : {0, 3'333, 95'001, 190'000})
    EXPECT_LT(apart(history.at(kStart + t), on_a_circle(kStart + t)), 1e-4) << t;
}

TEST(OdometryHistory, GoesOnForALittleWhileBeyondTheLastSample) {
  const OdometryHistory history = history_of(20);
  const std::int64_t last = kStart + 19 * kPeriod;
  EXPECT_TRUE(history.covers(kStart, last + OdometryHistory::kLead));
  EXPECT_FALSE(history.covers(kStart, last + OdometryHistory::kLead + 1));
  const Pose at = history.at(last + OdometryHistory::kLead);
  const Pose truth = on_a_circle(last + OdometryHistory::kLead);
  EXPECT_LT(apart(at, truth), 1e-6);
  EXPECT_LT(angle_of(at.inverse() * truth), 1e-6);
}

TEST(OdometryHistory, GoesOnAlsoWhereSamplesAreFarApart) {
  OdometryHistory history;
  for (int i = 0; i <= 40; i += 10) (void)history.add(sample(i));  // 10 Hz
  const std::int64_t utime = kStart + 40 * kPeriod + 15'000;
  EXPECT_LT(apart(history.at(utime), on_a_circle(utime)), 1e-6);
}

TEST(OdometryHistory, SaysWhereItCoastedOnTheWheels) {
  OdometryHistory history;
  for (int i = 0; i < 20; ++i) {
    odometry_t message{};
    const OdometrySample s = sample(i);
    message.utime = s.utime;
    pose_to_arrays(s.T_odom_base, message.position, message.orientation);
    message.flags = odometry_t::INITIALISED | (i == 9 ? odometry_t::NO_IMU : 0);
    EXPECT_EQ(history.add(sample_of(message).value()), OdometryHistory::Added::kYes);
  }
  EXPECT_TRUE(history.with_gyro(kStart, kStart + 8 * kPeriod));
  EXPECT_FALSE(history.with_gyro(kStart, kStart + 10 * kPeriod));
  EXPECT_TRUE(history.with_gyro(kStart + 10 * kPeriod, kStart + 19 * kPeriod));
}

TEST(OdometryHistory, WithOneSampleTheVehicleIsThere) {
  const OdometryHistory history = history_of(1);
  EXPECT_TRUE(history.covers(kStart, kStart + 10'000));
  EXPECT_EQ(apart(history.at(kStart + 10'000), Pose::Identity()), 0);
}

TEST(OdometryHistory, SaysTheSameWhetherOrNotMoreWasThereInTime) {
  const std::int64_t end = kStart + 15 * kPeriod + 4'000;
  OdometryHistory early;
  for (int i = 0; !early.reaches(end); ++i) (void)early.add(sample(i));
  OdometryHistory late = history_of(40);
  early.set_horizon(end);
  late.set_horizon(end);
  EXPECT_TRUE(late.covers(kStart + 30'000, end));
  EXPECT_TRUE(early.at(end).isApprox(late.at(end), 0));
  EXPECT_TRUE(early.at(end - 7'000).isApprox(late.at(end - 7'000), 0));
  EXPECT_FALSE(late.covers(kStart, kStart + 35 * kPeriod)) << "not known yet";
  late.set_horizon(kStart + 35 * kPeriod);
  EXPECT_TRUE(late.covers(kStart, kStart + 35 * kPeriod));
}

TEST(OdometryHistory, DoesNotCoverAGapNorWhatIsNotUsable) {
  OdometryHistory history = history_of(5);
  (void)history.add(sample(40));
  EXPECT_FALSE(history.covers(kStart, kStart + 40 * kPeriod)) << "350 ms without a sample";
  (void)history.add(sample(41, false));
  EXPECT_TRUE(history.covers(kStart + 40 * kPeriod, kStart + 40 * kPeriod));
  EXPECT_FALSE(history.covers(kStart + 40 * kPeriod, kStart + 41 * kPeriod));
  EXPECT_FALSE(OdometryHistory{}.covers(kStart, kStart));
}

/// The host's clock was set forward by 0.3 s in mid-drive: nothing was driven meanwhile.
TEST(OdometryHistory, CoversAStepOfTheClock) {
  const auto stepped = [](int i) {
    OdometrySample later = sample(i);
    later.utime += 300'000;
    return later;
  };
  OdometryHistory history = history_of(10);
  for (int i = 13; i < 20; ++i) (void)history.add(stepped(i));  // the filter takes three samples to be sure
  EXPECT_TRUE(history.covers(kStart + 60'000, kStart + 470'000));
  EXPECT_LT(apart(history.at(kStart + 90'000), on_a_circle(kStart + 90'000)), 1e-9);
  EXPECT_LT(apart(history.at(kStart + 450'000), on_a_circle(kStart + 150'000)), 1e-9);
  OdometryHistory at_the_edge;
  for (int i : {9}) (void)at_the_edge.add(sample(i));
  for (int i = 13; i < 20; ++i) (void)at_the_edge.add(stepped(i));
  EXPECT_TRUE(at_the_edge.covers(kStart + 90'000, kStart + 470'000));
  OdometryHistory stands;
  for (int i = 0; i < 100; ++i)
    if (i < 20 || i > 60) (void)stands.add({kStart + i * kPeriod, Pose::Identity(), true, true});
  EXPECT_TRUE(stands.covers(kStart, kStart + 990'000));
}

TEST(OdometryHistory, LeavesOutWhatIsLateAndBeginsAnewWhenTheClockJumps) {
  OdometryHistory history = history_of(300);
  EXPECT_EQ(history.add(sample(299)), OdometryHistory::Added::kLate);
  EXPECT_EQ(history.add(sample(250)), OdometryHistory::Added::kLate);
  for (int i = 10; i < 29; ++i) EXPECT_EQ(history.add(sample(i)), OdometryHistory::Added::kLate) << i;
  EXPECT_EQ(history.add(sample(29)), OdometryHistory::Added::kClockJump);
  EXPECT_FALSE(history.covers(kStart, kStart));
  EXPECT_TRUE(history.covers(kStart + 10 * kPeriod, kStart + 29 * kPeriod)) << "nothing of the new clock is lost";
}

/// lcm-logplayer with a log of the same vehicle, on a busy host: its messages come in bursts.
TEST(OdometryHistory, ALogThatIsPlayedIntoTheBusChangesNothing) {
  OdometryHistory history = history_of(300);
  for (int i = 300; i < 1000; ++i) {
    EXPECT_EQ(history.add(sample(i)), OdometryHistory::Added::kYes);
    for (int k = 0; i % 10 == 0 && k < 10; ++k) {
      OdometrySample old = sample(i + k);
      old.utime -= 3'600'000'000;
      EXPECT_EQ(history.add(old), OdometryHistory::Added::kLate);
    }
  }
  EXPECT_TRUE(history.covers(kStart + 300 * kPeriod, kStart + 999 * kPeriod));
}

/// Half a second back: what the filter says goes on from there. A message that comes twice, on two ways, does not.
TEST(OdometryHistory, BeginsAnewWhereTheClockWasSetBackALittle) {
  OdometryHistory history = history_of(300);
  for (int i = 250; i < 254; ++i) EXPECT_EQ(history.add(sample(i)), OdometryHistory::Added::kLate) << i;
  EXPECT_EQ(history.add(sample(254)), OdometryHistory::Added::kClockJump);
  EXPECT_EQ(history.add(sample(255)), OdometryHistory::Added::kYes);
  for (int i = 256; i < 400; ++i) {
    EXPECT_EQ(history.add(sample(i)), OdometryHistory::Added::kYes);
    EXPECT_NE(history.add(sample(i - 50)), OdometryHistory::Added::kClockJump);
  }
}

/// Another filter: it began 3 m and half a turn from where the first one did.
OdometrySample elsewhere(int i) {
  OdometrySample other = sample(i);
  other.T_odom_base = move({Eigen::Vector3d(3, 0, 0), Eigen::Vector3d(0, 0, 1.5)}, 1.0) * other.T_odom_base;
  return other;
}

TEST(OdometryHistory, OfTwoFiltersTheFirstIsUsedInWhateverOrderTheyCome) {
  OdometryHistory history = history_of(100);
  for (int i = 100; i < 300; ++i) {
    const bool before = i % 3 == 0;
    if (before) {
      EXPECT_EQ(history.add(elsewhere(i)), OdometryHistory::Added::kElsewhere);
    }
    EXPECT_EQ(history.add(sample(i)), OdometryHistory::Added::kYes);
    if (!before) {
      EXPECT_EQ(history.add(elsewhere(i)), OdometryHistory::Added::kLate);
    }
    EXPECT_LT(apart(history.at(sample(i).utime), sample(i).T_odom_base), 1e-9);
    EXPECT_EQ(history.has_second_filter(), i >= 105) << "once may be a wrong sample";
  }
  for (int i = 300; i < 400; ++i) (void)history.add(sample(i));
  EXPECT_FALSE(history.has_second_filter()) << "it ended";
}

/// On a busy host both come in bursts.
TEST(OdometryHistory, OfTwoFiltersTheFirstIsUsedWhereTheOtherIsAheadByABurst) {
  OdometryHistory history = history_of(100);
  for (int i = 100; i < 300; i += 15) {
    for (int k = i; k < i + 15; ++k) EXPECT_EQ(history.add(elsewhere(k)), OdometryHistory::Added::kElsewhere);
    for (int k = i; k < i + 15; ++k) EXPECT_EQ(history.add(sample(k)), OdometryHistory::Added::kYes);
  }
}

TEST(OdometryHistory, AFilterThatLeapsIsFollowedWithoutAGap) {
  for (const int every : {1, 2, 3}) {  // 100, 50 and 33 Hz
    OdometryHistory history;
    for (int i = 0; i < 99; i += every) (void)history.add(sample(i));
    int i = 99;
    for (; elsewhere(i).utime - history.newest() <= OdometryHistory::kMaxGap; i += every)
      EXPECT_EQ(history.add(elsewhere(i)), OdometryHistory::Added::kElsewhere);
    EXPECT_FALSE(history.reaches(elsewhere(i).utime));
    EXPECT_EQ(history.add(elsewhere(i)), OdometryHistory::Added::kYes);
    EXPECT_TRUE(history.covers(kStart, elsewhere(i).utime)) << every;
    EXPECT_LT(apart(history.at(elsewhere(99).utime), elsewhere(99).T_odom_base), 1e-9);
    EXPECT_EQ(history.add(elsewhere(i + every)), OdometryHistory::Added::kYes);
    EXPECT_FALSE(history.has_second_filter());
  }
}

TEST(OdometryHistory, ASecondFilterOfBeforeTheClockWasSetBackIsNotReported) {
  OdometryHistory history = history_of(300);
  for (int i = 300; i < 400; ++i) {
    (void)history.add(elsewhere(i));
    (void)history.add(sample(i));
  }
  EXPECT_TRUE(history.has_second_filter());
  for (int i = 10; i < 30; ++i) (void)history.add(sample(i));
  EXPECT_EQ(history.newest(), sample(29).utime);
  EXPECT_FALSE(history.has_second_filter());
}

TEST(OdometryHistory, AFilterThatIsCorrectedGoesOn) {
  OdometryHistory history = history_of(100);
  for (int i = 100; i < 200; ++i) {
    OdometrySample corrected = sample(i);
    corrected.T_odom_base.translation().y() += 0.15;
    EXPECT_EQ(history.add(corrected), OdometryHistory::Added::kYes);
  }
}

TEST(OdometryHistory, AGapIsNotFilledByAnotherFilter) {
  OdometryHistory history = history_of(100);
  for (int i = 105; i < 120; ++i) (void)history.add(sample(i));
  EXPECT_FALSE(history.fill(elsewhere(102)));
  EXPECT_TRUE(history.fill(sample(102)));
}

TEST(OdometryHistory, ForgetsWhatIsNotNeeded) {
  OdometryHistory history = history_of(100);
  history.forget_before(kStart + 505'000);
  EXPECT_FALSE(history.covers(kStart + 490'000, kStart + 600'000));
  EXPECT_TRUE(history.covers(kStart + 505'000, kStart + 600'000));
}

/// The last scan before the clock was set back is processed after odometry has followed.
TEST(OdometryHistory, ATimeOfTheClockBeforeForgetsNothing) {
  OdometryHistory history = history_of(100);
  history.forget_before(kStart + 3'000'000);
  EXPECT_TRUE(history.covers(kStart + 505'000, kStart + 600'000));
  EXPECT_EQ(history.soon_after(kStart - 500'000), nullptr);
  ASSERT_NE(history.soon_after(kStart - 100'000), nullptr);
  EXPECT_EQ(history.soon_after(kStart - 100'000)->utime, kStart);
}

TEST(OdometryHistory, TurnIsConfirmedWhereTheFilterSaysSoAllThrough) {
  OdometryHistory history;
  for (int i = 0; i < 30; ++i) {
    odometry_t message{};
    message.utime = 1'700'000'000'000'000 + 10'000 * i;
    message.orientation[0] = 1;
    message.flags = odometry_t::INITIALISED;
    if (i != 10 && i != 20) message.flags |= +odometry_t::TURN_CONFIRMED;
    const auto sample = sample_of(message);
    ASSERT_TRUE(sample);
    (void)history.add(*sample);
  }
  const auto confirmed = [&](int from, int to) {
    return history.turn_confirmed(1'700'000'000'000'000 + 10'000 * from, 1'700'000'000'000'000 + 10'000 * to);
  };
  EXPECT_TRUE(confirmed(0, 9));
  for (const int i : {10, 20}) EXPECT_FALSE(confirmed(i - 2, i + 2)) << i;
  EXPECT_TRUE(confirmed(21, 29));
}

}  // namespace
}  // namespace curbstone::mapper::scan
