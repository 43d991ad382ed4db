#include "services/ekf/detection/still_detector.hpp"

#include <gtest/gtest.h>

#include <random>

namespace curbstone::ekf::detection {
namespace {

constexpr double kRadius = 0.1;           // m
constexpr double kMaxWheelGap = 0.2;      // s
constexpr std::int64_t kPeriod = 10'000;  // us, of IMU and wheels
const Eigen::Vector3d kNoBias = Eigen::Vector3d::Zero();

/// A vehicle on a slope, measured at 100 Hz.
class StillDetectorTest : public ::testing::Test {
 protected:
  void imu(double rate_sigma, double acceleration_sigma) {
    base::ImuSample sample{utime_, mean_rate_, mean_acceleration_};
    for (int i = 0; i < 3; ++i) {
      sample.angular_rate[i] += rate_sigma * unit_(random_);
      sample.acceleration[i] += acceleration_sigma * unit_(random_);
    }
    detector_.add(sample);
  }
  void wheels(double left, double right) {
    detector_.add(base::WheelSample{utime_, {left / kRadius, right / kRadius}});
  }
  /// Seconds with the noise of a vehicle whose engine idles.
  void stand(double seconds) {
    for (double t = 0; t < seconds - 1e-9; t += 0.01, utime_ += kPeriod) {
      wheels(1, 2);
      imu(0.004, 0.05);
    }
  }
  [[nodiscard]] bool still() const { return detector_.still(kNoBias); }

  base::StandstillConfig config_;  // a window is 0.5 s
  StillDetector detector_{config_, kRadius, kMaxWheelGap};
  std::int64_t utime_ = 1'000'000;
  Eigen::Vector3d mean_rate_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_acceleration_{1.0, 0.0, 9.7};
  std::mt19937 random_{1};
  std::normal_distribution<double> unit_;
};

TEST_F(StillDetectorTest, AVehicleStandsOnceAllOfTheWindowWasQuiet) {
  stand(0.5);  // fifty samples: 0.49 s from the first to the last
  EXPECT_FALSE(still());
  stand(0.01);
  EXPECT_TRUE(still());
  stand(5);
  EXPECT_TRUE(still());
}

TEST_F(StillDetectorTest, NothingIsStillOfWhichOneSensorSaysNothing) {
  for (int i = 0; i < 200; ++i, utime_ += kPeriod) wheels(1, 1);
  EXPECT_FALSE(still());
  detector_.reset();
  for (int i = 0; i < 200; ++i, utime_ += kPeriod) imu(0, 0);
  EXPECT_FALSE(still());
}

TEST_F(StillDetectorTest, WheelsThatFellSilentProveNothingAnyLonger) {
  stand(1);
  for (int i = 0; i < 19; ++i, utime_ += kPeriod) imu(0.004, 0.05);
  EXPECT_TRUE(still()) << "the last word of the wheels is 0.19 s old";
  for (int i = 0; i < 3; ++i, utime_ += kPeriod) imu(0.004, 0.05);
  EXPECT_FALSE(still());
}

TEST_F(StillDetectorTest, TheGyrosBiasIsNoTurnButAnEvenTurnIsNoStandstill) {
  mean_rate_.z() = 0.08;
  stand(1);
  EXPECT_TRUE(detector_.still(mean_rate_));
  EXPECT_FALSE(detector_.still(kNoBias));
}

TEST_F(StillDetectorTest, AnEngineThatIdlesIsQuietAndARoadIsNot) {
  struct Noise {
    double rate, acceleration;
    bool quiet;
  };
  for (const Noise& noise : {Noise{0.007, 0.11, true}, {0.014, 0.01, false}, {0.001, 0.21, false}}) {
    detector_.reset();
    int quiet = 0;
    for (int i = 0; i < 300; ++i, utime_ += kPeriod) {
      wheels(1, 1);
      imu(noise.rate, noise.acceleration);
      quiet += i >= 60 && still() ? 1 : 0;
    }
    EXPECT_EQ(quiet, noise.quiet ? 240 : 0) << noise.rate << " rad/s, " << noise.acceleration << " m/s^2";
  }
}

TEST_F(StillDetectorTest, OneSampleFarOffEndsTheStandstillAtOnce) {
  stand(1);
  base::ImuSample jerk{utime_, mean_rate_, mean_acceleration_};
  jerk.angular_rate.z() +=
      0.06;  // of fifty samples it makes a standard deviation of 0.0084 rad/s: no variance shows it
  wheels(1, 2);
  detector_.add(jerk);
  EXPECT_FALSE(still());
}

TEST_F(StillDetectorTest, AWheelThatCreepsIsNoStandstillACountThatFlickersIsOne) {
  for (const auto& [travel, stands] : {std::pair{0.9 * 5e-4, true}, {1.1 * 5e-4, false}}) {
    for (const bool left : {true, false}) {
      detector_.reset();
      for (int i = 0; i < 100; ++i, utime_ += kPeriod) {
        const double at = i % 7 == 0 ? travel : 0;
        wheels(left ? at : 0, left ? 0 : at);
        imu(0.004, 0.05);
      }
      EXPECT_EQ(still(), stands) << travel;
    }
  }
}

TEST_F(StillDetectorTest, AVehicleThatRollsEvenlyIsNotStillHoweverQuietItsImu) {
  for (int i = 0; i < 100; ++i, utime_ += kPeriod) {
    wheels(0.001 * i, 0.001 * i);
    imu(0, 0);
  }
  EXPECT_FALSE(still());
}

TEST_F(StillDetectorTest, WheelsTurnOnceOneHasGoneACentimetreWithinTheWindow) {
  stand(1);
  EXPECT_FALSE(detector_.wheels_turn());
  wheels(1, 2 + 0.0099);
  EXPECT_FALSE(detector_.wheels_turn());
  utime_ += kPeriod;
  wheels(1, 2 + 0.0101);
  EXPECT_TRUE(detector_.wheels_turn());
}

TEST_F(StillDetectorTest, MeansAreThoseOfTheWindow) {
  mean_rate_ << 0.01, -0.02, 0.03;
  stand(3);
  EXPECT_NEAR(detector_.span(), 0.5, 1e-9);
  // 51 samples: the mean is off by a seventh of one sample's noise, and hardly ever by three times that.
  EXPECT_LT((detector_.mean_rate() - mean_rate_).cwiseAbs().maxCoeff(), 3 * 0.004 / 7);
  EXPECT_LT((detector_.mean_acceleration() - mean_acceleration_).cwiseAbs().maxCoeff(), 3 * 0.05 / 7);
}

TEST_F(StillDetectorTest, AResetForgetsTheStandstill) {
  stand(1);
  ASSERT_TRUE(still());
  detector_.reset();
  EXPECT_FALSE(still());
  EXPECT_EQ(detector_.span(), 0);
  EXPECT_FALSE(detector_.wheels_turn());
}

}  // namespace
}  // namespace curbstone::ekf::detection
