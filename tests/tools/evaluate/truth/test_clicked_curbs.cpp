#include "tools/evaluate/truth/clicked_curbs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "tests/temporary_folder.hpp"

namespace curbstone::evaluate::truth {
namespace {

StreetLabels clicked(const std::string& rows, const Pose& T_world_first = Pose::Identity()) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path() / "curbs.csv") << rows;
  return read_clicked_curbs(folder.path().string(), T_world_first);
}

TEST(ClickedCurbs, APolylineIsACurbEachTenCentimetres) {
  const auto labels = clicked("\xEF\xBB\xBFline,x,y\n1,5, 3 \n1,10,3\r\n2,5,-3\n2,10,-3\n");
  ASSERT_NEAR(static_cast<double>(labels.curbs.size()), 102, 2);
  for (const TrueCurbPoint& point : labels.curbs) {
    EXPECT_NEAR(std::abs(point.y), 3, 1e-9);
    EXPECT_GE(point.x, 5);
    EXPECT_LE(point.x, 10);
    EXPECT_FALSE(point.dropped);
    EXPECT_GE(point.height, 0.04);
  }
}

TEST(ClickedCurbs, WhatLiesBesideALineIsKnownAndNothingElse) {
  const auto labels = clicked("1,5,3\n1,10,3\n");
  EXPECT_EQ(labels.border_at(7, 1, 0, 1), Border::kNone);
  EXPECT_EQ(labels.border_at(7, 5, 0, 1), Border::kNone);
  EXPECT_EQ(labels.border_at(7, -1, 0, 1), Border::kNotKnown) << "farther beside it";
  EXPECT_EQ(labels.border_at(12, 3, 0, 1), Border::kNotKnown) << "where nobody clicked on";
}

TEST(ClickedCurbs, MayHaveHeightsAndLoweredKerbs) {
  const auto labels = clicked(
      "line,x,y,z,height,dropped\n1,5,3,-1.7,0.12,0\n1,8,3,-1.7,0.12,0\n2,8,3,-1.7,0.02,1\n"
      "2,9,3,-1.7,0.02,1\n");
  EXPECT_FALSE(labels.curbs.front().dropped);
  EXPECT_NEAR(labels.curbs.front().z, -1.7, 1e-9);
  EXPECT_TRUE(labels.curbs.back().dropped);
  EXPECT_NEAR(labels.curbs.back().height, 0.02, 1e-9);
}

TEST(ClickedCurbs, LieInTheTruthsFrame) {
  Pose T_world_first = Pose::Identity();
  T_world_first.translation() = Eigen::Vector3d(100, 50, 0);
  EXPECT_NEAR(clicked("1,5,3\n1,10,3\n", T_world_first).curbs.front().x, 105, 1e-9);
}

TEST(ClickedCurbs, WhatCannotBeReadIsNamedWithItsLine) {
  for (const std::string rows : {"1,5,3\n1,x,3\n", "1,5,3\n1,5\n", "1,5,3\n1,1e9,3\n", "1,5,3\n1,nan,3\n",
                                 "1,5,3\n1,5 m,3\n", "1,5,3\n1;5;3\n", "1,5,3\n1,5,3,7,3\n"}) {
    try {
      (void)clicked(rows);
      ADD_FAILURE() << rows;
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find("curbs.csv:2"), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW((void)clicked(""), std::runtime_error);
  EXPECT_THROW((void)clicked("1,5,3\n1,5000,3\n"), std::runtime_error);
}

}  // namespace
}  // namespace curbstone::evaluate::truth
