#include "common/statistics/quantile.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace curbstone {
namespace {

double quantile_of(std::vector<double> values, double q) {
  return quantile_in_place(values, q);
}

TEST(Quantile, IsTheValueOfTheNearestRank) {
  const std::vector<double> values = {40, 10, 50, 20, 30};
  EXPECT_EQ(quantile_of(values, 0), 10);
  EXPECT_EQ(quantile_of(values, 0.5), 30);
  EXPECT_EQ(quantile_of(values, 1), 50);
  EXPECT_EQ(quantile_of(values, 0.12), 10) << "rank 0.48";
  EXPECT_EQ(quantile_of(values, 0.13), 20) << "rank 0.52";
}

TEST(Quantile, RoundsAHalfUp) {
  EXPECT_EQ(quantile_of({1, 2}, 0.5), 2);
  EXPECT_EQ(quantile_of({1, 2, 3, 4}, 0.5), 3);
  EXPECT_EQ(quantile_of({1, 2, 3}, 0.25), 2);
}

TEST(Quantile, OfOneValueIsThatValue) {
  for (const double q : {0.0, 0.3, 1.0}) EXPECT_EQ(quantile_of({7}, q), 7);
}

TEST(Quantile, IsThatOfTheSortedValues) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> number(-5, 5);
  for (std::size_t n = 1; n < 60; ++n) {
    std::vector<double> values(n);
    for (double& value : values) value = std::round(number(random));  // many are equal
    std::vector<double> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    for (const double q : {0.0, 0.2, 0.25, 0.5, 0.7, 0.8, 0.95, 0.99, 1.0}) {
      const auto rank = static_cast<std::size_t>(std::floor(q * static_cast<double>(n - 1) + 0.5));
      EXPECT_EQ(quantile_of(values, q), sorted[rank]) << q << " of " << n;
    }
  }
}

TEST(Quantile, OfManyValuesInAnyOrderIsThatOfTheSortedOnes) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> number(-5, 5);
  for (const std::size_t n : {100U, 257U, 2000U}) {
    std::vector<double> mixed(n);
    for (double& value : mixed) value = number(random);
    std::vector<double> rising = mixed;
    std::sort(rising.begin(), rising.end());
    const std::vector<double> falling(rising.rbegin(), rising.rend());
    std::vector<double> organ_pipe = rising;
    std::reverse(organ_pipe.begin() + static_cast<std::ptrdiff_t>(n / 2), organ_pipe.end());
    for (const double q : {0.0, 0.2, 0.5, 0.8, 1.0}) {
      const auto rank = static_cast<std::size_t>(std::floor(q * static_cast<double>(n - 1) + 0.5));
      for (const std::vector<double>& values : {mixed, rising, falling, organ_pipe})
        EXPECT_EQ(quantile_of(values, q), rising[rank]) << q << " of " << n;
      EXPECT_EQ(quantile_of(std::vector<double>(n, 3.0), q), 3);
    }
  }
}

TEST(Quantile, InPlaceKeepsTheValuesAndTheCopyingOneTheirOrder) {
  std::vector<double> values = {3, 1, 2, 5, 4};
  const std::vector<double> before = values;
  EXPECT_EQ(quantile_or(values, 0.5, 0), 3);
  EXPECT_EQ(values, before);
  EXPECT_EQ(quantile_in_place(values, 0.5), 3);
  EXPECT_THAT(values, testing::UnorderedElementsAreArray(before));
}

TEST(Quantile, OfNothingIsWhatTheCallerSays) {
  EXPECT_EQ(quantile_or({}, 0.5, -1), -1);
  EXPECT_TRUE(std::isnan(quantile_or({}, 0.5, std::numeric_limits<double>::quiet_NaN())));
}

}  // namespace
}  // namespace curbstone
