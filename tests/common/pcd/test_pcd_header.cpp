#include "common/pcd/pcd_header.hpp"

#include <gtest/gtest.h>

namespace curbstone {
namespace {

TEST(PcdHeaderTest, IsThatOfTheFormatsDescription) {
  constexpr PcdField kFields[] = {{"x"}, {"y"}, {"z"}, {"class", 'U'}};
  EXPECT_EQ(pcd_header(kFields, 213),
            "# .PCD v0.7 - Point Cloud Data file format\n"
            "VERSION 0.7\n"
            "FIELDS x y z class\n"
            "SIZE 4 4 4 4\n"
            "TYPE F F F U\n"
            "COUNT 1 1 1 1\n"
            "WIDTH 213\n"
            "HEIGHT 1\n"
            "VIEWPOINT 0 0 0 1 0 0 0\n"
            "POINTS 213\n"
            "DATA binary\n");
}

TEST(PcdHeaderTest, TheViewpointIsPlaceThenQuaternionWFirst) {
  Pose pose = Pose::Identity();
  pose.translation() << 1, -2, 0.5;
  pose.linear() = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix();
  constexpr PcdField kFields[] = {{"x"}};
  const std::string header = pcd_header(kFields, 0, pose);
  EXPECT_NE(header.find("VIEWPOINT 1 -2 0.5 "), std::string::npos) << header;
  EXPECT_NE(header.find(" 1 0 0\nPOINTS 0\n"), std::string::npos) << header;
}

}  // namespace
}  // namespace curbstone
