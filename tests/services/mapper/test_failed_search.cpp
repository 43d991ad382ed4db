#include "services/mapper/failed_search.hpp"

#include <gtest/gtest.h>

namespace curbstone::mapper {
namespace {

/// Twenty scans a second of a vehicle at `speed`, m/s, until it is given up; s, 60 if it is not.
double given_up_after(double speed, bool with_odometry = true) {
  FailedSearch search;
  for (int i = 0; i < 1200; ++i) {
    const double t = 0.05 * i;
    const Eigen::Vector3d in_odom(speed * t, 0, 0);
    search.add(1'000'000 + 50'000 * i, with_odometry ? std::optional(in_odom) : std::nullopt);
    if (search.is_hopeless()) return t;
  }
  return 60;
}

TEST(FailedSearch, IsGivenUpAfterSomeSecondsAndMetres) {
  EXPECT_NEAR(given_up_after(6), 12, 0.1);
  EXPECT_NEAR(given_up_after(1), 24, 0.1);
  EXPECT_EQ(given_up_after(0), 60) << "whoever stands may wait for a lorry to drive on";
}

TEST(FailedSearch, TakesLongerWhereNothingSaysHowFarTheVehicleWent) {
  EXPECT_NEAR(given_up_after(6, false), 24, 0.1);
}

TEST(FailedSearch, CountsNeitherAGapNorTheStepIntoAnotherOdomFrame) {
  FailedSearch search;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d in_odom(i < 100 ? 0 : 1000, 0, 0);
    search.add(1'000'000 + 50'000 * i + (i < 50 ? 0 : 20'000'000), in_odom);
  }
  EXPECT_NEAR(search.seconds(), 9.9, 0.1);
  EXPECT_FALSE(search.is_hopeless());
}

}  // namespace
}  // namespace curbstone::mapper
