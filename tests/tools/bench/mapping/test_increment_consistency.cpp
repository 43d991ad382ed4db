#include "tools/bench/mapping/increment_consistency.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "services/mapper/registration/normal_equations.hpp"
#include "tests/services/mapper/mapper_drive.hpp"

namespace curbstone::bench::mapping {
namespace {

mapper::registration::Vector6 sigma() {
  mapper::registration::Vector6 out;
  out << 0.01, 0.02, 0.03, 1e-3, 2e-3, 5e-4;
  return out;
}

/// The NEES of poses that are off by sigma() and claim `claim` times as much. The truth is known between them.
Nees of_claim(double claim) {
  const mapper::scan::Twist twist{{5, 0, 0.1}, {0, 0.02, 0.3}};
  evaluate::truth::Trajectory truth;
  for (int i = -2; i < 1010; ++i) truth.push_back({100'000 * i + 50'000, mapper::scan::move(twist, 0.1 * i + 0.05)});
  IncrementConsistency consistency(truth, 500'000);
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 1000; ++i) {
    mapper::registration::Vector6 error;
    for (int k = 0; k < 6; ++k) error[k] = sigma()[k] * normal(random);
    consistency.add({100'000 * i, mapper::scan::move(twist, 0.1 * i) * mapper::registration::exp_of(error)},
                    claim * claim * mapper::registration::Matrix6(sigma().cwiseAbs2().asDiagonal()));
  }
  return consistency.mean();
}

TEST(IncrementConsistencyTest, OfHonestClaimsIsTheNumberOfDirections) {
  const Nees nees = of_claim(1);
  EXPECT_NEAR(nees.increments, 995, 1);
  EXPECT_NEAR(nees.all, 6, 0.5);
  EXPECT_NEAR(nees.translation, 3, 0.3);
  EXPECT_NEAR(nees.rotation, 3, 0.3);
}

TEST(IncrementConsistencyTest, IsFourTimesThatOfWhoClaimsHalfTheError) {
  EXPECT_NEAR(of_claim(0.5).all, 24, 2);
}

TEST(IncrementConsistencyTest, NeedsATruthAndAPoseAboutSoLongBefore) {
  evaluate::truth::Trajectory truth;
  for (int i = 0; i < 20; ++i) truth.push_back({100'000 * i, Pose::Identity()});
  IncrementConsistency consistency(truth, 500'000);
  for (const std::int64_t utime : {0, 300'000, 1'000'000, 9'000'000, 9'500'000})
    consistency.add({utime, Pose::Identity()}, mapper::registration::Matrix6::Identity());
  EXPECT_EQ(consistency.mean().increments, 0);
  EXPECT_EQ(consistency.mean().all, 0);
}

/// A vehicle whose body pitches and rolls on its springs, which no steady motion foresees.
Pose shaken(double t) {
  constexpr double kOnce = 2 * 3.14159265358979;
  return test::driving(t) * test::pose(0, 0, 0.004 * std::sin(kOnce * 1.7 * t), 0.004 * std::sin(kOnce * 2.3 * t),
                                       0.003 * std::sin(kOnce * 2.9 * t + 1), 0);
}

Nees of_shaken_drive(const std::string& method, bool with_odometry) {
  test::MapperDrive drive(method);
  drive.trajectory = shaken;
  if (with_odometry) drive.with_odometry(4);
  evaluate::truth::Trajectory truth;
  for (int i = -2; i < 410; ++i) truth.push_back({test::utime(0.01 * i), shaken(0.01 * i)});
  IncrementConsistency consistency(truth, 500'000);
  for (int i = 0; i < 70; ++i) {
    const auto update = drive.step();
    if (update && update->registered)
      consistency.add({update->utime, update->T_map_base}, update->registration.covariance);
  }
  return consistency.mean();
}

/// Six is exact. By the equations of registration alone it would be 14 without odometry, for the motion within a
/// revolution is a guess; the planes of this world are perfect, so with odometry it is careful.
TEST(IncrementConsistencyTest, TheMapperIsHonestAboutAShakenVehicleWithAndWithoutOdometry) {
  for (const char* method : {"icp", "loam"}) {
    const Nees guessed = of_shaken_drive(method, false);
    EXPECT_GT(guessed.increments, 50);
    EXPECT_LT(guessed.all, 6) << method;
    EXPECT_LT(guessed.rotation, 4) << method;
    EXPECT_GT(guessed.rotation, 0.3) << method << " claims to know nothing";
    const Nees guided = of_shaken_drive(method, true);
    EXPECT_LT(guided.all, 6) << method;
    EXPECT_GT(guided.all, 0.005) << method;
  }
}

}  // namespace
}  // namespace curbstone::bench::mapping
