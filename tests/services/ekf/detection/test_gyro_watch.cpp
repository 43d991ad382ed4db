#include "services/ekf/detection/gyro_watch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "tests/services/ekf/real_drives.hpp"

namespace curbstone::ekf::detection {
namespace {

/// A gyro of noise and, where its vehicle drives, shaking, all behind a low-pass; in steps.
struct GyroKind {
  std::string name;
  double rate = 100.0;      // Hz
  double step = 0.0;        // rad/s; 0: a float
  double bandwidth = 40.0;  // Hz
  double dead_zone = 0.0;   // rad/s, below which it shows 0
};

struct Shaking {
  std::array<double, 3> sigma = {};  // rad/s, of the three axes
};

class MovingGyro {
 public:
  MovingGyro(const GyroKind& kind, const Shaking& shaking, unsigned seed)
      : kind_(kind), shaking_(shaking), random_(seed) {}

  Eigen::Vector3d next() {
    constexpr double kDensity = 1e-4;  // rad/s/sqrt(Hz)
    const double forget = 1.0 - std::exp(-2 * std::numbers::pi * kind_.bandwidth / kind_.rate);
    const double band = std::min(kind_.bandwidth * std::numbers::pi / 2, kind_.rate / 2);
    Eigen::Vector3d out;
    for (int i = 0; i < 3; ++i) {
      const double sigma = std::hypot(kDensity * std::sqrt(band), shaking_.sigma[static_cast<std::size_t>(i)]);
      filtered_[i] += forget * (sigma * std::sqrt((2 - forget) / forget) * normal_(random_) - filtered_[i]);
      const double rate = filtered_[i] + 0.3 * kind_.step * i;
      out[i] = kind_.step > 0 ? kind_.step * std::round(rate / kind_.step) : rate;
      if (std::abs(out[i]) < kind_.dead_zone) out[i] = 0.0;
    }
    return out;
  }

 private:
  GyroKind kind_;
  Shaking shaking_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  Eigen::Vector3d filtered_ = Eigen::Vector3d::Zero();
};

constexpr double kWitStep = 2000.0 / 32768 * std::numbers::pi / 180;  // rad/s
constexpr double kDegree = std::numbers::pi / 180;

const std::vector<GyroKind>& gyro_kinds() {
  static const std::vector<GyroKind> kinds = {
      {"floats", 100, 0},
      {"250_deg_in_16_bits", 100, 250.0 / 32768 * kDegree},
      {"500_deg_in_16_bits_at_5_Hz", 400, 500.0 / 32768 * kDegree, 5},
      {"race_car", 217, kDegree / 80, 30},
      {"1000_deg_in_16_bits", 200, 1000.0 / 32768 * kDegree},
      {"WitMotion", 100, kWitStep, 20},
      {"WitMotion_at_5_Hz", 200, kWitStep, 5, 3 * kWitStep},
      {"a_tenth_of_a_degree", 100, 0.1 * kDegree},
  };
  return kinds;
}

class GyroWatchOf : public ::testing::TestWithParam<GyroKind> {
 protected:
  /// s after the start when an axis is called stuck; 0: never.
  double run(const Shaking& shaking, double seconds, int stuck_axis = -1, double stuck_from = 0, unsigned seed = 1) {
    MovingGyro gyro(GetParam(), shaking, seed);
    const auto samples = static_cast<int>(seconds * GetParam().rate);
    Eigen::Vector3d held = Eigen::Vector3d::Zero();
    for (int i = 0; i < samples; ++i) {
      const double t = i / GetParam().rate;
      Eigen::Vector3d rate = gyro.next();
      if (stuck_axis >= 0 && t >= stuck_from) rate[stuck_axis] = held[stuck_axis];
      held = rate;
      watch_.add(1'000'000 + std::llround(1e6 * t), rate);
      if (watch_.stuck(0) || watch_.stuck(1) || watch_.stuck(2)) return t;
    }
    return 0.0;
  }
  GyroWatch watch_;
};

TEST_P(GyroWatchOf, NoAxisIsStuckAtRest) {
  EXPECT_EQ(run({}, 1200), 0.0);
}

TEST_P(GyroWatchOf, NoAxisIsStuckWhereItShakes) {
  for (const double sigma : {0.001, 0.003, 0.01, 0.03}) {
    for (const double straight : {0.5, 0.25, 0.1}) {
      watch_ = {};
      EXPECT_EQ(run({{sigma, sigma, straight * sigma}}, 300), 0.0) << sigma << ", " << straight;
    }
  }
}

TEST_P(GyroWatchOf, AnAxisThatIsStuckOnRoughGroundIsFound) {
  for (int axis = 0; axis < 3; ++axis) {
    watch_ = {};
    const double found = run({{0.05, 0.05, 0.05}}, 60, axis, 20);
    const bool fine = GetParam().step <= GyroWatch::kFine;
    std::printf("[ figure ] %s: axis %d found after %.2f s\n", GetParam().name.c_str(), axis, found - 20);
    EXPECT_GT(found, 20.2) << axis;
    EXPECT_LT(found, fine ? 20.4 : 31.0) << axis;
    EXPECT_TRUE(watch_.stuck(axis));
    EXPECT_NEAR(static_cast<double>(watch_.since(axis)), 21e6, 2e4);
  }
}

/// What shakes about one axis alone, as on a turntable, proves nothing about the two others.
TEST_P(GyroWatchOf, NoAxesAreStuckWhereItShakesAboutOne) {
  for (const double sigma : {0.003, 0.03, 0.3}) {
    for (int axis = 0; axis < 3; ++axis) {
      watch_ = {};
      Shaking shaking;
      shaking.sigma[static_cast<std::size_t>(axis)] = sigma;
      EXPECT_EQ(run(shaking, 1200), 0.0) << sigma << ", " << axis;
    }
  }
}

TEST_P(GyroWatchOf, AnAxisThatIsStuckFromTheStartIsFoundAtRestWhereStepsAreFine) {
  for (int axis = 0; axis < 3; ++axis) {
    watch_ = {};
    const double found = run({}, 60, axis, 0);
    // At rest a coarse gyro, and a slow one, repeat themselves too often for an axis to be alone.
    if (GetParam().step <= 2e-4) {
      EXPECT_GT(found, 0.2);
      EXPECT_LT(found, 3.0);
    } else if (found > 0) {
      EXPECT_TRUE(watch_.stuck(axis));
    }
  }
}
INSTANTIATE_TEST_SUITE_P(All, GyroWatchOf, ::testing::ValuesIn(gyro_kinds()),
                         [](const auto& of) { return of.param.name; });

/// Samples of floats at 100 Hz.
class GyroWatchTest : public ::testing::Test {
 protected:
  void add(double seconds, const std::array<bool, 3>& frozen = {}, int times = 1) {
    for (int i = 0; i < 100 * seconds; ++i) {
      const Eigen::Vector3d rate = gyro_.next();
      for (int k = 0; k < 3; ++k) {
        if (!frozen[static_cast<std::size_t>(k)]) shown_[k] = rate[k];
      }
      for (int k = 0; k < times; ++k) watch_.add(utime_ += 10'000 / times, shown_);
    }
  }
  GyroWatch watch_;
  MovingGyro gyro_{gyro_kinds()[0], {}, 7};
  Eigen::Vector3d shown_ = Eigen::Vector3d::Zero();
  std::int64_t utime_ = 1'000'000;
};

TEST_F(GyroWatchTest, AnAxisIsTrustedAgainAfterTwoSecondsOfChanges) {
  add(3);
  add(0.5, {false, false, true});
  EXPECT_TRUE(watch_.stuck(2));
  add(1.9);
  EXPECT_TRUE(watch_.stuck(2));
  add(0.2);
  EXPECT_FALSE(watch_.stuck(2));
}

TEST_F(GyroWatchTest, AnAxisThatMovesNowAndThenIsNotTrusted) {
  add(3);
  add(0.5, {true, false, false});
  for (int i = 0; i < 10; ++i) {
    add(1.5);
    EXPECT_TRUE(watch_.stuck(0)) << i;
    add(0.2, {true, false, false});
  }
}

TEST_F(GyroWatchTest, OfTwoAxesThatShowNothingNoneIsCalledStuck) {
  add(60, {true, true, false});  // a gyro about the vertical alone
  EXPECT_FALSE(watch_.stuck(0) || watch_.stuck(1) || watch_.stuck(2));
}

TEST_F(GyroWatchTest, TwoAxesThatHaveLivedAndGetStuckInOneMomentAreFound) {
  for (const std::array<bool, 3>& frozen :
       {std::array{true, true, false}, std::array{true, false, true}, std::array{false, true, true}}) {
    watch_ = {};
    add(3);
    add(0.9, frozen);
    EXPECT_FALSE(watch_.stuck(0) || watch_.stuck(1) || watch_.stuck(2));
    add(0.3, frozen);
    for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(watch_.stuck(axis), frozen[static_cast<std::size_t>(axis)]) << axis;
    add(2.5);
    EXPECT_FALSE(watch_.stuck(0) || watch_.stuck(1) || watch_.stuck(2));
  }
}

TEST_F(GyroWatchTest, ThreeAxesThatHaveLivedAndGetStuckInOneMomentAreFound) {
  add(3);
  add(0.9, {true, true, true});
  EXPECT_FALSE(watch_.stuck(0) || watch_.stuck(1) || watch_.stuck(2));
  add(0.3, {true, true, true});
  EXPECT_TRUE(watch_.stuck(0) && watch_.stuck(1) && watch_.stuck(2));
  add(2.5);
  EXPECT_FALSE(watch_.stuck(0) || watch_.stuck(1) || watch_.stuck(2));
}

TEST_F(GyroWatchTest, ThreeAxesThatShowZeroAreFoundOnceTheWheelsTurn) {
  const auto show_zero = [&](double seconds, bool drives) {
    for (int i = 0; i < 100 * seconds; ++i) watch_.add(utime_ += 10'000, Eigen::Vector3d::Zero(), {}, drives);
  };
  add(3);
  show_zero(60, false);
  show_zero(0.9, true);
  EXPECT_FALSE(watch_.stuck(0) || watch_.stuck(1) || watch_.stuck(2)) << "a device that shows nothing at a standstill";
  show_zero(0.3, true);
  EXPECT_TRUE(watch_.stuck(0) && watch_.stuck(1) && watch_.stuck(2));
  add(2.5);
  EXPECT_FALSE(watch_.stuck(0) || watch_.stuck(1) || watch_.stuck(2));
}

/// What is small is 0 there: about two axes it may be for as long as it turns about the third.
TEST_F(GyroWatchTest, OfADeviceWithADeadZoneNoTwoAxesAreStuckAtZero) {
  const auto turn = [&](double seconds, const Eigen::Vector3d& level) {
    for (int i = 0; i < 100 * seconds; ++i) {
      Eigen::Vector3d rate = gyro_.next() + level;
      for (double& r : rate) r = std::abs(r) < 0.01 ? 0 : r;
      watch_.add(utime_ += 10'000, rate);
    }
  };
  turn(5, {0.1, 0.1, 0.1});
  turn(60, {0, 0, 0.1});
  EXPECT_FALSE(watch_.stuck(0) || watch_.stuck(1) || watch_.stuck(2));
  shown_.setZero();
  watch_ = {};
  add(5);
  add(1.2, {true, true, false});
  EXPECT_TRUE(watch_.stuck(0) && watch_.stuck(1)) << "it has shown less before, so it has no such zone";
}

TEST_F(GyroWatchTest, ASecondAxisIsFoundAfterTheFirst) {
  add(3);
  add(1, {true, false, false});
  add(1, {true, true, false});
  EXPECT_TRUE(watch_.stuck(0));
  EXPECT_TRUE(watch_.stuck(1));
  EXPECT_FALSE(watch_.stuck(2));
}

TEST_F(GyroWatchTest, SamplesThatComeFourTimesShowAsMuch) {
  add(60, {}, 4);
  EXPECT_FALSE(watch_.stuck(0) || watch_.stuck(1) || watch_.stuck(2));
  add(0.5, {false, true, false}, 4);
  EXPECT_TRUE(watch_.stuck(1));
}

TEST_F(GyroWatchTest, AfterAPauseOrAStepBackItBeginsAnew) {
  add(3);
  for (const std::int64_t step : {-5'000'000, 2'000'000}) {
    add(0.2, {false, false, true});
    utime_ += step;
    add(0.2, {false, false, true});
    EXPECT_FALSE(watch_.stuck(2)) << step;
    add(0.1);
  }
}

class GyroWatchOnRealDrives : public ::testing::TestWithParam<std::string> {};

TEST_P(GyroWatchOnRealDrives, NoAxisIsCalledStuckUnlessItIs) {
  const auto drive = real_drive(GetParam());
  if (!drive) GTEST_SKIP() << "the recording is not there";
  GyroWatch healthy;
  int longest = 0;
  std::array<int, 3> alone{};
  for (std::size_t i = 1; i < drive->drive.imu.size(); ++i) {
    const base::ImuSample& sample = drive->drive.imu[i];
    healthy.add(sample.utime, sample.angular_rate);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_FALSE(healthy.stuck(axis)) << i;
      const Eigen::Vector3d change = sample.angular_rate - drive->drive.imu[i - 1].angular_rate;
      const bool others = change[(axis + 1) % 3] != 0 && change[(axis + 2) % 3] != 0;
      int& run = alone[static_cast<std::size_t>(axis)];
      run = change[axis] == 0 ? run + (others ? 1 : 0) : 0;
      longest = std::max(longest, run);
    }
  }
  std::printf("[ figure ] %s: an axis repeats itself for at most %d samples in which the others change\n",
              GetParam().c_str(), longest);
  for (int axis = 0; axis < 3; ++axis) {
    GyroWatch watch;
    bool found = false;
    for (std::size_t i = 0; i < drive->drive.imu.size(); ++i) {
      Eigen::Vector3d rate = drive->drive.imu[i].angular_rate;
      if (i > drive->drive.imu.size() / 2) rate[axis] = 0.0;
      watch.add(drive->drive.imu[i].utime, rate);
      found = found || watch.stuck(axis);
    }
    EXPECT_TRUE(found) << axis;
    GyroWatch of_two;
    bool both = false;
    for (std::size_t i = 0; i < drive->drive.imu.size(); ++i) {
      Eigen::Vector3d rate = drive->drive.imu[i].angular_rate;
      if (i > drive->drive.imu.size() / 2) rate[axis] = rate[(axis + 1) % 3] = 0.01;
      of_two.add(drive->drive.imu[i].utime, rate);
      both = both || (of_two.stuck(axis) && of_two.stuck((axis + 1) % 3));
      EXPECT_FALSE(of_two.stuck((axis + 2) % 3));
    }
    EXPECT_TRUE(both) << axis;
  }
}
INSTANTIATE_TEST_SUITE_P(All, GyroWatchOnRealDrives, ::testing::ValuesIn(real_drive_names()),
                         [](const auto& of) { return of.param; });

}  // namespace
}  // namespace curbstone::ekf::detection
