#include "services/ekf/detection/wheel_watch.hpp"

#include <gtest/gtest.h>

namespace curbstone::ekf::detection {
namespace {

constexpr std::int64_t kStep = 50'000;  // us

/// Wheels against a filter that believes to drive at `expected`.
struct Drive {
  WheelWatch watch{base::SlipConfig()};
  std::int64_t time = 0;
  double inertial = 0;
  WheelWatch::Finding step(std::array<double, 2> speed, double expected, bool turning = false) {
    WheelWatch::Look look;
    look.begin = time;
    look.end = time += kStep;
    look.speed = speed;
    look.expected = {expected, expected};
    look.sigma = {0.03, 0.03};
    for (std::size_t i = 0; i < 2; ++i) look.refused[i] = std::abs(speed[i] - expected) > 8 * 0.03;
    look.turning = turning;
    look.inertial_speed = inertial = expected;
    return watch.add(look);
  }
  WheelWatch::Finding run(double seconds, std::array<double, 2> speed, double expected) {
    WheelWatch::Finding found = WheelWatch::Finding::kNone;
    for (int i = 0; i < static_cast<int>(seconds * 20 + 0.5); ++i) {
      const auto finding = step(speed, expected);
      if (finding != WheelWatch::Finding::kNone) found = finding;
    }
    return found;
  }
};

TEST(WheelWatchTest, AWheelThatIsRefusedForThePatienceIsFaulty) {
  Drive drive;
  drive.run(10, {3, 3}, 3);
  drive.run(4.8, {0, 3}, 3);
  EXPECT_FALSE(drive.watch.faulty(0));
  drive.run(0.4, {0, 3}, 3);
  EXPECT_TRUE(drive.watch.faulty(0));
  EXPECT_FALSE(drive.watch.faulty(1));
  EXPECT_NEAR(drive.watch.ratio(0), 0, 1e-9);
  EXPECT_FALSE(drive.watch.hides_motion());
}

TEST(WheelWatchTest, SlipThatEndsIsNoFault) {
  Drive drive;
  for (int i = 0; i < 100; ++i) {
    drive.run(0.7, {4, 3}, 3);
    drive.run(2.3, {3, 3}, 3);
  }
  EXPECT_FALSE(drive.watch.faulty(0));
}

TEST(WheelWatchTest, ItIsTrustedAgainAfterTenSecondsOfAgreement) {
  Drive drive;
  drive.run(6, {6, 3}, 3);
  ASSERT_TRUE(drive.watch.faulty(0));
  drive.run(20, {0, 0}, 0);  // standing proves nothing
  drive.run(9.5, {3, 3}, 3);
  EXPECT_TRUE(drive.watch.faulty(0));
  drive.run(1, {3, 3}, 3);
  EXPECT_FALSE(drive.watch.faulty(0));
}

TEST(WheelWatchTest, BothThatShowAMultipleOfTheSpeedAreFaulty) {
  for (const double k : {0.0, -1.0, 0.5, 2.0}) {
    Drive drive;
    drive.run(10, {3, 3}, 3);
    EXPECT_EQ(drive.run(5.2, {3 * k, 3 * k}, 3), WheelWatch::Finding::kWheels) << k;
    EXPECT_TRUE(drive.watch.all_faulty());
    EXPECT_NEAR(drive.watch.ratio(1), k, 0.01);
    EXPECT_EQ(drive.watch.hides_motion(), k == 0.0);
    EXPECT_EQ(drive.watch.pull(), 0.0) << "they went astray at a stroke";
  }
}

/// Its tilt is wrong: the filter speeds up, the wheels go on as before.
TEST(WheelWatchTest, AFilterThatDriftsAwayEvenlyIsWrongItself) {
  for (const double drift : {-1.0, 0.7, 2.0}) {
    Drive drive;
    drive.run(10, {3, 3}, 3);
    WheelWatch::Finding found = WheelWatch::Finding::kNone;
    for (int i = 0; i < 120 && found == WheelWatch::Finding::kNone; ++i)
      found = drive.step({3, 3}, 3 + drift * 0.05 * i);
    EXPECT_EQ(found, WheelWatch::Finding::kFilter) << drift;
    EXPECT_FALSE(drive.watch.faulty(0) || drive.watch.faulty(1));
  }
}

TEST(WheelWatchTest, AFilterWhoseImuWasHitIsWrongItself) {
  Drive drive;
  drive.run(10, {3, 3}, 3);
  EXPECT_EQ(drive.run(5.2, {3, 3}, 5), WheelWatch::Finding::kFilter);
  EXPECT_FALSE(drive.watch.faulty(0) || drive.watch.faulty(1));
}

TEST(WheelWatchTest, WheelsThatTurnOtherwiseThanTheGyroAreFaulty) {
  Drive drive;
  drive.run(10, {3, 3}, 3);
  WheelWatch::Finding found = WheelWatch::Finding::kNone;
  for (int i = 0; i < 120 && found == WheelWatch::Finding::kNone; ++i)
    found = drive.step({2.5, 3.5}, 3 + 0.05 * i, i < 40);
  EXPECT_EQ(found, WheelWatch::Finding::kWheels);
}

}  // namespace
}  // namespace curbstone::ekf::detection
