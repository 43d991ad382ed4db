#include <gtest/gtest.h>

#include "common/linear/decompositions.hpp"
#include "tests/services/ekf/drawn_drives.hpp"
#include "tests/services/ekf/town_drive.hpp"
#include "tests/services/ekf/wheel_fault.hpp"

namespace curbstone::ekf::filter {
namespace {

constexpr double kSeconds = 90.0;

struct Outcome {
  double position = 0.0;               // m, largest error on the ground from the onset on
  double yaw = 0.0;                    // rad, likewise
  double sigmas = 0.0;                 // largest error on the ground by the covariance, once the fault is recognised
  double yaw_sigmas = 0.0;             // likewise
  double sigmas_before = 0.0;          // largest error on the ground by the covariance, before both are found faulty
  double when_found = 0.0;             // m, error on the ground when both wheels are found faulty
  double sigmas_without_wheels = 0.0;  // from then on
  int false_stands = 0;                // estimates that say it stands while it drives
  Counters counters;
  [[nodiscard]] std::int64_t faults(std::size_t wheel) const {
    Counters c = counters;
    return c[wheel == 0 ? "faults.wheel_left" : "faults.wheel_right"];
  }
};

Outcome outcome_of(const base::EkfConfig& config, const Drive& drive, double onset, double recognised) {
  Filter filter(config);
  const auto out = run(filter, drive);
  const std::size_t start = drive.index_of(out.front().utime);
  Outcome outcome;
  for (const model::Estimate& e : out) {
    const double t = base::seconds_between(drive.imu.front().utime, e.utime);
    if (t < onset) continue;
    const std::size_t i = drive.index_of(e.utime);
    const Pose truth = drive.T_odom_base(i, start);
    const Eigen::Vector2d error = (e.T_odom_base.translation() - truth.translation()).head<2>();
    const Eigen::Matrix2d covariance = e.pose_covariance.topLeftCorner<2, 2>();
    const double yaw = roll_pitch_yaw(e.T_odom_base.linear()).z() - roll_pitch_yaw(truth.linear()).z();
    outcome.position = std::max(outcome.position, error.norm());
    outcome.yaw = std::max(outcome.yaw, std::abs(std::remainder(yaw, 2 * M_PI)));
    const double sigmas = std::sqrt(error.dot(Ldlt<2>(covariance).solve(error)));
    if (t > recognised) {
      outcome.sigmas = std::max(outcome.sigmas, sigmas);
      outcome.yaw_sigmas =
          std::max(outcome.yaw_sigmas, std::abs(std::remainder(yaw, 2 * M_PI)) / std::sqrt(e.pose_covariance(5, 5)));
    }
    if (e.no_wheels && outcome.sigmas_without_wheels == 0.0) outcome.when_found = error.norm();
    const bool before = !e.no_wheels && outcome.sigmas_without_wheels == 0.0;
    if (before && error.norm() > 0.03) outcome.sigmas_before = std::max(outcome.sigmas_before, sigmas);
    if (e.no_wheels) outcome.sigmas_without_wheels = std::max(outcome.sigmas_without_wheels, sigmas);
    outcome.false_stands += e.stationary && drive.truth[i].velocity.norm() > 0.5 ? 1 : 0;
  }
  outcome.counters = filter.counters();
  return outcome;
}

Drive town(unsigned number, double speed = 3.0) {
  TownDriveOptions options;
  options.seconds = kSeconds;
  options.seed = 2000 + number;
  options.town = number;
  options.speed = speed;
  return simulate_town_drive(options, base::EkfConfig().vehicle);
}

/// From its first metre on: the filter has little to go by, and the wheels pull it along.
TEST(WheelFaults, OfBothFromTheStartAreFoundAndWhatTheyCostIsInTheCovariance) {
  const base::EkfConfig config;
  for (const unsigned number : {1U, 2U}) {
    for (const double speed : {3.0, 5.0}) {
      const Drive good = town(number, speed);
      for (const WheelFault& fault : tried_wheel_faults()) {
        if (!fault.of_both_wheels()) continue;
        const Outcome o = outcome_of(config, with_fault(good, fault, 1.0), 1.0, 0.0);
        std::printf(
            "[ figure ] town %u, %.0f m/s, %s from the start: %.2f m when it is found, at most %.2f m, %.1f sigma\n",
            number, speed, fault.name.c_str(), o.when_found, o.position, o.sigmas_without_wheels);
        EXPECT_LT(o.sigmas_without_wheels, 3.5) << fault.name;
        EXPECT_EQ(o.faults(0), 1) << fault.name;
        EXPECT_EQ(o.faults(1), 1) << fault.name;
      }
    }
  }
}

/// The wheels rest while it drives off, and the accelerometer is not sure at first: from 3 cm on the covariance knows.
TEST(WheelFaults, OfBothThatStandStillFromTheStartAreInTheCovarianceBeforeTheyAreFound) {
  const base::EkfConfig config;
  const WheelFault frozen{"both frozen", {0, 0}};
  for (const unsigned number : {1U, 2U}) {
    for (const double speed : {0.7, 1.5, 3.0, 5.0}) {
      const Outcome o = outcome_of(config, with_fault(town(number, speed), frozen, 1.0), 1.0, 0.0);
      std::printf("[ figure ] town %u, %.1f m/s: %.1f sigma before it is found\n", number, speed, o.sigmas_before);
      EXPECT_LT(o.sigmas_before, 4.5) << speed;  // believing the wheels: 100
    }
  }
}

/// As a drive that restarts in mid-drive makes it, where its counts are few enough to be believed by the encoder's
/// driver (up to 1.1 rad at 100 Hz, 18 rad at 10 Hz), or a lost half turn.
/// Of the counts, one in `thinned` is kept.
void expect_no_travel_by_a_leap(int thinned) {
  const base::EkfConfig config;
  Drive good = town(1);
  std::vector<base::WheelSample> kept;
  for (std::size_t i = 0; i < good.wheels.size(); i += static_cast<std::size_t>(thinned))
    kept.push_back(good.wheels[i]);
  good.wheels = kept;
  const Outcome undisturbed = outcome_of(config, good, 0.5, 0.5);
  for (const double at : {1.5, 20.0, 47.0}) {  // at rest, straight ahead, in a bend
    for (const auto& leap :
         std::vector<std::array<double, 2>>{{M_PI, 0}, {0, -M_PI}, {-1.1, -1.1}, {-18, -18}, {6, 6}}) {
      Drive drive = good;
      for (base::WheelSample& sample : drive.wheels) {
        if (base::seconds_between(good.wheels.front().utime, sample.utime) < at) continue;
        for (std::size_t i = 0; i < 2; ++i) sample.angle[i] += leap[i];
      }
      const Outcome o = outcome_of(config, drive, 0.5, 0.5);
      std::printf("[ figure ] %d Hz, %.1f and %.1f rad at %.1f s: %.2f m, %.1f sigma (undisturbed %.2f m)\n",
                  100 / thinned, leap[0], leap[1], at, o.position, o.sigmas, undisturbed.position);
      EXPECT_LT(o.position, undisturbed.position + 0.2);
      EXPECT_EQ(o.faults(0) + o.faults(1), 0);
    }
  }
}

TEST(WheelFaults, ALeapOfTheCountsIsNoTravel) {
  expect_no_travel_by_a_leap(10);
}

TEST(WheelFaults, ALeapOfTheCountsAtAHundredHertzIsNoTravel) {  // long
  expect_no_travel_by_a_leap(1);
}

/// Nobody knows then how it turns, and the covariance says so.
void expect_carried_on_without_imu(unsigned number) {
  const base::EkfConfig config;
  const Drive good = town(number);
  for (const WheelFault& fault : tried_wheel_faults()) {
    if (!fault.of_one_wheel() && !fault.of_both_wheels()) continue;
    Drive drive = with_fault(good, fault, 20.0);
    const std::int64_t begin = drive.imu.front().utime;
    std::erase_if(drive.imu, [&](const base::ImuSample& sample) {
      const double t = base::seconds_between(begin, sample.utime);
      return t > 50 && t < 55;
    });
    const Outcome o = outcome_of(config, drive, 20.0, 50.0);
    std::printf("[ figure ] town %u, %s and no IMU for 5 s: %.2f m, %.2f deg, %.1f and %.1f sigma\n", number,
                fault.name.c_str(), o.position, o.yaw * 180 / M_PI, o.sigmas, o.yaw_sigmas);
    EXPECT_LT(o.sigmas, 3.5) << fault.name;
    EXPECT_LT(o.yaw_sigmas, 3.5) << fault.name;
    EXPECT_LE(o.faults(0) + o.faults(1), fault.of_one_wheel() ? 1 : 2) << fault.name;
  }
}

TEST(WheelFaults, WithoutTheImuTheWheelThatIsTrustedCarriesItOn) {
  expect_carried_on_without_imu(1);
}

TEST(WheelFaults, WithoutTheImuTheWheelThatIsTrustedCarriesItOnInAnotherTown) {  // long
  expect_carried_on_without_imu(2);
}

/// Set on at speed, and while it stands.
class LastingWheelFault : public ::testing::TestWithParam<double> {};

TEST_P(LastingWheelFault, OfOneWheelCostsNothingAndIsNamed) {
  const base::EkfConfig config;
  for (const unsigned number : {1U, 2U}) {
    const Drive good = town(number);
    const Outcome undisturbed = outcome_of(config, good, GetParam(), GetParam());
    for (const WheelFault& fault : tried_wheel_faults()) {
      if (!fault.of_one_wheel()) continue;
      const Outcome o = outcome_of(config, with_fault(good, fault, GetParam()), GetParam(), GetParam() + 8);
      std::printf("[ figure ] town %u, %s: %.2f m (undisturbed %.2f), %.2f deg, %.1f sigma\n", number,
                  fault.name.c_str(), o.position, undisturbed.position, o.yaw * 180 / M_PI, o.sigmas);
      EXPECT_LT(o.position, undisturbed.position + 0.5) << fault.name;
      EXPECT_LT(o.yaw, undisturbed.yaw + 0.006) << fault.name;
      EXPECT_LT(o.sigmas, 3.0) << fault.name;
      EXPECT_EQ(o.faults(0), fault.gain[0] != 1 ? 1 : 0) << fault.name;
      EXPECT_EQ(o.faults(1), fault.gain[1] != 1 ? 1 : 0) << fault.name;
    }
  }
}

TEST_P(LastingWheelFault, OfBothWheelsLeavesTheImuAndAnHonestCovariance) {
  const base::EkfConfig config;
  for (const unsigned number : {1U, 2U}) {
    const Drive good = town(number);
    for (const WheelFault& fault : tried_wheel_faults()) {
      if (!fault.of_both_wheels()) continue;
      const Outcome o = outcome_of(config, with_fault(good, fault, GetParam()), GetParam(), GetParam() + 12);
      std::printf("[ figure ] town %u, %s: %.2f m, %.2f deg, %.1f sigma\n", number, fault.name.c_str(), o.position,
                  o.yaw * 180 / M_PI, o.sigmas);
      EXPECT_LT(o.position, 15.0) << fault.name;  // believing the wheels: 34 to 190 m
      EXPECT_LT(o.sigmas, 3.5) << fault.name;
      EXPECT_EQ(o.faults(0), 1) << fault.name;
      EXPECT_EQ(o.faults(1), 1) << fault.name;
      EXPECT_EQ(o.false_stands, 0) << fault.name;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(SetOn, LastingWheelFault, ::testing::Values(35.0, 45.0),
                         [](const auto& at) { return at.param < 40 ? "WhileStanding" : "AtSpeed"; });

TEST(WheelFaults, AWheelThatIsRepairedIsTrustedAgain) {
  const base::EkfConfig config;
  Drive drive = town(1);
  const std::int64_t begin = drive.wheels.front().utime;
  double lost = 0;
  double last = drive.wheels.front().angle[0];
  for (base::WheelSample& sample : drive.wheels) {  // it does not count from 20 s to 40 s
    const double t = base::seconds_between(begin, sample.utime);
    if (t > 20 && t < 40) lost += sample.angle[0] - last;
    last = sample.angle[0];
    sample.angle[0] -= lost;
  }
  Filter filter(config);
  const auto out = run(filter, drive);
  Counters counters = filter.counters();
  EXPECT_EQ(counters["faults.wheel_left"], 1);
  EXPECT_EQ(counters["trusted.wheel_left"], 1);
  EXPECT_FALSE(filter.wheel_watch().faulty(0));
  EXPECT_LT(end_error(out, drive), 0.015);
}

/// It is the filter that is wrong here, and both wheels that put it right.
TEST(WheelFaults, ABlowToTheImuIsNotBlamedOnTheWheels) {
  const base::EkfConfig config;
  for (const double blow : {-150.0, 150.0}) {  // m/s^2 for 20 ms: 3 m/s
    Drive drive = town(1);
    for (std::size_t i = 2000; i < 2002; ++i) drive.imu[i].acceleration.x() += blow;
    const Outcome o = outcome_of(config, drive, 20, 30);
    Counters counters = o.counters;
    EXPECT_EQ(o.faults(0) + o.faults(1), 0);
    EXPECT_GE(counters["reset.doubt"], 1);
  }
}

TEST(WheelFaults, AnImuThatIsKnockedAskewIsNotBlamedOnTheWheels) {
  const base::EkfConfig config;
  for (const double by : {-1.5, 1.5}) {
    Drive drive = town(1);
    for (std::size_t i = 2000; i < drive.imu.size(); ++i) drive.imu[i].acceleration.x() += by;
    const Outcome o = outcome_of(config, drive, 20, 40);
    EXPECT_EQ(o.faults(0) + o.faults(1), 0) << by;
  }
}

TEST(WheelFaults, UndisturbedDrivesWithholdNothing) {
  const base::EkfConfig config;
  std::size_t samples = 0;
  for (const unsigned number : {1U, 2U}) {
    for (const double speed : {0.7, 3.0, 5.0}) {
      const Drive drive = town(number, speed);
      Outcome o = outcome_of(config, drive, 0, 0);
      samples += drive.wheels.size();
      EXPECT_EQ(o.counters["withheld.wheel_left"] + o.counters["withheld.wheel_right"], 0);
      EXPECT_EQ(o.counters["standstills.moved"], 0);
    }
  }
  std::printf("[ figure ] of %zu samples none is withheld\n", samples);
}

}  // namespace
}  // namespace curbstone::ekf::filter
