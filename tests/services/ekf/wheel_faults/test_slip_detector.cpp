#include "services/ekf/wheel_faults/slip_detector.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace curbstone::ekf::wheel_faults {
namespace {

constexpr double kSlipInterval = 0.05;  // s, of the wheels

class SlipDetectorTest : public ::testing::Test {
 protected:
  /// Intervals from now on, with the wheels' speed off the inertial one by `off(t)`; the time of the first sign, or -1.
  double first_speeding(double seconds, const std::function<double(double)>& off) {
    const double begin = time_;
    const int intervals = static_cast<int>(std::lround(seconds / kSlipInterval));
    for (int i = 0; i <= intervals; ++i) {
      const double t = kSlipInterval * i;
      time_ = begin + t;
      const double inertial = 2 * std::sin(t);  // the vehicle speeds up and slows down
      if (detector_.add({.end = time_, .wheel_speed = inertial + off(t), .inertial_speed = inertial}).speeding)
        return t;
    }
    time_ += kSlipInterval;
    return -1;
  }
  bool turning(double wheels, double gyro) {
    return detector_.add({.end = time_ += kSlipInterval, .wheel_yaw_rate = wheels, .gyro_yaw_rate = gyro}).turning;
  }
  base::SlipConfig config_;
  SlipDetector detector_{config_};
  double time_ = 100;
};

TEST_F(SlipDetectorTest, WheelsThatSayWhatTheImuSaysDoNotSlip) {
  EXPECT_EQ(first_speeding(20, [](double) { return 0.0; }), -1);
  for (const double rate : {0.0, 0.5, -2.0}) EXPECT_FALSE(turning(rate, rate));
}

TEST_F(SlipDetectorTest, AWheelThatTurnsTheVehicleMoreThanTheGyroDoesSlips) {
  EXPECT_FALSE(turning(config_.yaw_rate - 0.001, 0));
  EXPECT_TRUE(turning(config_.yaw_rate + 0.001, 0));
  EXPECT_TRUE(turning(-config_.yaw_rate - 0.001, 0));
}

TEST_F(SlipDetectorTest, InAFastTurnTheWheelsMayBeOffByAShareOfIt) {
  const double allowed = config_.yaw_rate + config_.yaw_share * 1.0;
  for (const double turn : {1.0, -1.0}) {
    EXPECT_FALSE(turning(turn + allowed - 0.001, turn));
    EXPECT_FALSE(turning(turn - allowed + 0.001, turn));
    EXPECT_TRUE(turning(turn + allowed + 0.001, turn));
    EXPECT_TRUE(turning(turn - allowed - 0.001, turn));
  }
}

TEST_F(SlipDetectorTest, WhereTheInertialSpeedBeganDoesNotMatter) {
  EXPECT_EQ(first_speeding(5, [](double) { return 1000.0; }), -1);
}

TEST_F(SlipDetectorTest, SlipThatGrowsSlowlyIsSeenOnceItHasGrownEnoughWithinTheWindow) {
  EXPECT_NEAR(first_speeding(5, [](double t) { return 1.1 * t; }), 0.30, 1e-9) << "0.275 m/s before, 0.33 m/s then";
  detector_.reset();
  EXPECT_NEAR(first_speeding(5, [](double t) { return -1.1 * t; }), 0.30, 1e-9) << "braked wheels";
}

TEST_F(SlipDetectorTest, WhatAnAccelerometersBiasMakesInAWindowIsNoSlip) {
  EXPECT_EQ(first_speeding(10, [](double t) { return 0.8 * t; }), -1) << "0.24 m/s over 0.3 s, however far it goes";
}

TEST_F(SlipDetectorTest, ASuddenSlipIsASignForAWindowFromItsBeginningAndFromItsEnd) {
  const auto spin = [](double t) { return t > 0.99 && t < 1.99 ? 1.0 : 0.0; };
  int signs = 0;
  for (int i = 0; i < 100; ++i) {
    const double t = kSlipInterval * i;
    const bool sign = detector_.add({.end = t, .wheel_speed = spin(t)}).speeding;
    const bool expected = (t > 0.99 && t < 1.29) || (t > 1.99 && t < 2.29);
    EXPECT_EQ(sign, expected) << t;
    signs += sign ? 1 : 0;
  }
  EXPECT_EQ(signs, 12);
}

TEST_F(SlipDetectorTest, WhatTheStampsJitterExplainsIsNoSlip) {
  const auto speeding = [&](double change, double jitter) {
    detector_.reset();
    (void)detector_.add({.end = time_ += kSlipInterval, .wheel_speed = 3.0, .jitter = jitter});
    return detector_.add({.end = time_ += kSlipInterval, .wheel_speed = 3.0 + change, .jitter = jitter}).speeding;
  };
  EXPECT_TRUE(speeding(0.4, 0.0));
  EXPECT_FALSE(speeding(0.4, 0.03)) << "each speed is known to 0.09 m/s";
  EXPECT_TRUE(speeding(1.0, 0.03));
  const auto turning = [&](double wheels, double jitter) {
    return detector_
        .add({.end = time_ += kSlipInterval, .wheel_yaw_rate = wheels, .gyro_yaw_rate = 1.0, .jitter = jitter})
        .turning;
  };
  EXPECT_TRUE(turning(1.25, 0.0));
  EXPECT_FALSE(turning(1.25, 0.03));
  EXPECT_TRUE(turning(1.4, 0.03));
}

TEST_F(SlipDetectorTest, AResetForgetsWhatWasBefore) {
  EXPECT_EQ(first_speeding(1, [](double) { return 0.0; }), -1);
  detector_.reset();
  EXPECT_EQ(first_speeding(1, [](double) { return 5.0; }), -1);
}

}  // namespace
}  // namespace curbstone::ekf::wheel_faults
