#include "services/mapper/returns/dead_lasers.hpp"

#include <gmock/gmock.h>

#include "tests/services/mapper/detection_scans.hpp"

namespace curbstone::mapper::returns {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class DeadLasersTest : public ::testing::Test {
 protected:
  DeadLasersTest() { drive_.trajectory = test::driving; }
  template <class Keeps>
  void check(int scans, bool moved, Keeps keeps) {
    for (int i = 0; i < scans; ++i) {
      scan::Scan scan = drive_.next();
      std::erase_if(scan.points, [&](const auto& point) { return !keeps(point); });
      lasers_.check(scan, moved);
    }
  }
  void check(int scans, const std::vector<int>& dead = {}) {
    check(scans, false,
          [&](const auto& point) { return std::find(dead.begin(), dead.end(), point.ring) == dead.end(); });
  }
  test::DetectionScans drive_;
  DeadLasers lasers_;
};

TEST_F(DeadLasersTest, AnySingleOneIsNamedUntilItReturnsAgain) {
  check(DeadLasers::kSteady);
  for (const int ring : {0, 5, 9}) {
    check(DeadLasers::kSilent - 1, {ring});
    EXPECT_THAT(lasers_.dead(), IsEmpty()) << "not yet";
    check(1, {ring});
    EXPECT_THAT(lasers_.dead(), ElementsAre(ring));
    check(DeadLasers::kBack);
    EXPECT_THAT(lasers_.dead(), IsEmpty());
  }
  EXPECT_EQ(lasers_.counters()["faults.lidar.dead_laser"], 3);
}

TEST_F(DeadLasersTest, ThreeOfFourAreNamed) {
  check(DeadLasers::kSteady);
  check(DeadLasers::kSilent, {1, 2, 3, 5, 6, 7});
  std::vector<std::string> faults;
  lasers_.add_faults(faults);
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_THAT(faults[0], HasSubstr("6 of its lasers (1, 2, 3, 5, 6, 7; 0: the lowest) return nothing any more"));
}

TEST_F(DeadLasersTest, OneThatFadesIsNamedOnTheMove) {
  check(DeadLasers::kSteady);
  for (const int kept : {400, 100, 20}) {
    int n = 0;
    check(20, true, [&](const auto& point) { return point.ring != 4 || n++ % 900 < kept; });
  }
  int n = 0;
  check(1, true, [&](const auto& point) { return point.ring != 4 || n++ < 5; });
  check(DeadLasers::kSilent, false, [&](const auto& point) { return point.ring != 4; });
  EXPECT_THAT(lasers_.dead(), IsEmpty()) << "the vehicle stands";
  check(DeadLasers::kBetween, true, [&](const auto& point) { return point.ring != 4; });
  EXPECT_THAT(lasers_.dead(), ElementsAre(4));
}

/// The house fronts end little by little; the sky returns nothing.
TEST_F(DeadLasersTest, TheUpperOnesInTheOpenAreSound) {
  check(DeadLasers::kSteady);
  for (float reach = 60; reach > 0; reach -= 0.5F)
    check(1, true, [&](const auto& point) { return point.ring < 8 || point.position.x() > 60 - reach; });
  int n = 0;
  check(1, true, [&](const auto& point) { return point.ring < 8 || (point.ring == 8 && n++ < 30); });
  check(300, true, [](const auto& point) { return point.ring < 8; });
  for (const int ring : lasers_.dead()) EXPECT_LT(ring, 8);
}

TEST_F(DeadLasersTest, WhatNeverReturnedIsNotReported) {
  check(300, {0, 3});
  EXPECT_THAT(lasers_.dead(), IsEmpty());
}

TEST_F(DeadLasersTest, PartsOfRevolutionsAndEmptyOnesSayNothing) {
  check(DeadLasers::kSteady);
  for (int i = 0; i < 200; ++i) {
    scan::Scan part = drive_.next();
    part.packets /= 2;
    std::erase_if(part.points, [](const auto& point) { return point.ring == 3; });
    lasers_.check(part, true);
    lasers_.check({}, true);
  }
  EXPECT_THAT(lasers_.dead(), IsEmpty());
}

}  // namespace
}  // namespace curbstone::mapper::returns
