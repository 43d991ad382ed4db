#include <gmock/gmock.h>

#include <curbstone/lidar_points_t.hpp>
#include <curbstone/map_pose_t.hpp>
#include <curbstone/map_trajectory_t.hpp>
#include <filesystem>

#include "tests/tools/log_tool/logged.hpp"

namespace curbstone::log_tool {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class LogTables : public LogToolTest {
 protected:
  /// Three revolutions of two packets with two points each, and a vehicle that drives at 1 m/s along x.
  std::string points(const std::string& name, bool with_poses, const std::string& mapper = "") const {
    LogWriter log(path(name));
    if (!mapper.empty()) write_config(log, "mapper", mapper, kBegin);
    for (int i = 0; i < 6; ++i) {
      lidar_points_t message{};
      message.utime = kBegin + i * 50'000;
      message.packet = i;
      message.revolution = 7 + i / 2;
      message.num_points = 2;
      message.x = {1, 2};
      message.y = {3, 4};
      message.z = {5, 6};
      message.time_offset = {0, 0.01F};
      message.intensity = {10, 20};
      message.ring = {0, 15};
      write(log, "LIDAR_POINTS", message);
      if (with_poses && i % 2 == 0) {
        map_pose_t pose{};
        pose.utime = message.utime;
        pose.map_base_position[0] = i * 0.05;
        pose.map_base_orientation[0] = pose.map_odom_orientation[0] = 1;
        write(log, "MAP_POSE", pose);
      }
    }
    return path(name);
  }
  /// The numbers behind the header of a PCD file.
  static std::vector<float> floats_of(const std::string& file) {
    const std::string bytes = bytes_of(file);
    const std::string data = bytes.substr(bytes.find("DATA binary\n") + 12);
    std::vector<float> floats(data.size() / sizeof(float));
    std::copy_n(data.data(), floats.size() * sizeof(float), reinterpret_cast<char*>(floats.data()));
    return floats;
  }
};

TEST_F(LogTables, AChannelIsATableOfItsFields) {
  EXPECT_EQ(run({"csv", drive("drive.lcmlog"), "--channel", "IMU"}), 0) << err_;
  EXPECT_THAT(out_, StartsWith("log_utime,utime,sequence,acceleration[0],acceleration[1],acceleration[2],"));
  EXPECT_THAT(out_, HasSubstr("\n1795467120100000,1795467120100000,1,0,0,0,"));
  EXPECT_EQ(std::count(out_.begin(), out_.end(), '\n'), 101);
}

TEST_F(LogTables, ARowIsAnElementWhereItIsWanted) {
  const std::string log = points("points.lcmlog", false);
  EXPECT_EQ(run({"csv", log, "--channel", "LIDAR_POINTS"}), 0) << err_;
  EXPECT_THAT(out_, StartsWith("log_utime,utime,packet,revolution,num_points\n"));
  EXPECT_THAT(err_, HasSubstr("without the arrays"));
  EXPECT_EQ(run({"csv", log, "--channel", "LIDAR_POINTS", "--elements", "--out", path("points.csv")}), 0) << err_;
  const std::string table = bytes_of(path("points.csv"));
  EXPECT_THAT(table,
              StartsWith("log_utime,utime,packet,revolution,num_points,element,x,y,z,time_offset,intensity,ring\n"
                         "1795467120000000,1795467120000000,0,7,2,0,1,3,5,0,10,0\n"
                         "1795467120000000,1795467120000000,0,7,2,1,2,4,6,0.01,20,15\n"));
}

TEST_F(LogTables, AChannelOfAnUnknownTypeIsAClearError) {
  EXPECT_EQ(run({"csv", drive("drive.lcmlog"), "--channel", "WHEELS"}), 1);
  EXPECT_THAT(err_, HasSubstr("10 messages of WHEELS have no known type"));
  EXPECT_EQ(run({"csv", drive("drive.lcmlog"), "--channel", "NONE", "--out", path("none.csv")}), 1);
  EXPECT_FALSE(std::filesystem::exists(path("none.csv")));
}

TEST_F(LogTables, EachScanIsAPointCloud) {
  const std::string log = points("points.lcmlog", false);
  EXPECT_EQ(run({"pcd", log, "--out", path("scans"), "--first", "1", "--count", "1"}), 0) << err_;
  const auto file = path("scans") + "/scan-1795467120100000.pcd";
  EXPECT_THAT(floats_of(file),
              ::testing::ElementsAre(1, 3, 5, 10, 0, 0, 2, 4, 6, 20, 15, 0.01F,  //
                                     1, 3, 5, 10, 0, 0.05F, 2, 4, 6, 20, 15, ::testing::FloatEq(0.06F)));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(path("scans")), {}), 1);
  EXPECT_EQ(run({"pcd", log, "--out", path("scans")}), 1) << "one of them is there";
  EXPECT_EQ(run({"pcd", log, "--out", path("scans"), "--force"}), 0) << err_;
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(path("scans")), {}), 3);
}

TEST_F(LogTables, MergedScansStandWhereTheVehicleWas) {
  EXPECT_EQ(run({"pcd", points("bare.lcmlog", false), "--merged", "--out", path("all.pcd")}), 1);
  EXPECT_THAT(err_, HasSubstr("no MAP_POSE"));
  EXPECT_FALSE(std::filesystem::exists(path("all.pcd.part")));
  const std::string log = points("poses.lcmlog", true);
  EXPECT_EQ(run({"pcd", log, "--merged", "--lidar", "0,0,2,0,0,0", "--out", path("all.pcd")}), 0) << err_;
  EXPECT_THAT(out_, HasSubstr("9 points in map, 3 without a pose left out")) << "behind the last pose";
  const std::vector<float> values = floats_of(path("all.pcd"));
  ASSERT_EQ(values.size(), 9 * 6U);
  EXPECT_NEAR(values[6 + 0], 2 + 0.01, 1e-5) << "10 ms after the first pose at 1 m/s";
  EXPECT_EQ(values[6 + 1], 4);
  EXPECT_EQ(values[6 + 2], 6 + 2) << "the LiDAR's height";
}

/// Two recorders of one drive, whose logs are joined.
TEST_F(LogTables, WhatTwoLogsHaveOfAScanIsInItOnce) {
  const std::string log = points("one.lcmlog", true);
  std::filesystem::copy_file(log, path("two.lcmlog"));
  EXPECT_EQ(run({"pcd", log, "--out", path("of_one")}), 0) << err_;
  EXPECT_THAT(err_, Not(HasSubstr("left out")));
  EXPECT_EQ(run({"pcd", log, path("two.lcmlog"), "--out", path("of_both")}), 0) << err_;
  EXPECT_THAT(err_, HasSubstr("6 packets came twice, or after their revolution, and are left out"));
  for (const auto& scan : std::filesystem::directory_iterator(path("of_one")))
    EXPECT_EQ(bytes_of(path("of_both") + "/" + scan.path().filename().string()), bytes_of(scan.path()));
  EXPECT_EQ(run({"pcd", log, "--merged", "--out", path("one.pcd")}), 0) << err_;
  EXPECT_EQ(run({"pcd", log, path("two.lcmlog"), "--merged", "--out", path("both.pcd")}), 0) << err_;
  EXPECT_EQ(bytes_of(path("both.pcd")), bytes_of(path("one.pcd")));
}

TEST_F(LogTables, TheLogThatIsReadIsNotReplacedByATable) {
  const std::string log = points("poses.lcmlog", true);
  const std::string bytes = bytes_of(log);
  EXPECT_EQ(run({"pcd", log, "--merged", "--out", log, "--force"}), 1);
  EXPECT_THAT(err_, HasSubstr("is read from"));
  EXPECT_EQ(run({"csv", log, "--channel", "MAP_POSE", "--out", log, "--force"}), 1);
  EXPECT_THAT(err_, HasSubstr("is read from"));
  EXPECT_EQ(bytes_of(log), bytes);
}

/// A closed loop moves the drive so far; MAP_POSE of before is void.
TEST_F(LogTables, MergedScansStandWhereTheLastEpochHasTheDrive) {
  {
    LogWriter log(path("poses.lcmlog"));
    lidar_points_t scan{};
    map_pose_t pose{};
    map_trajectory_t corrected{};
    pose.map_base_orientation[0] = pose.map_odom_orientation[0] = 1;
    for (int i = 0; i <= 40; ++i) {
      scan.utime = pose.utime = kBegin + i * 100'000;
      scan.revolution = i;
      scan.num_points = 1;
      scan.x = {1};
      scan.y = scan.z = scan.time_offset = {0};
      scan.intensity = scan.ring = {1};
      write(log, "LIDAR_POINTS", scan);
      pose.epoch = i < 40 ? 1 : 2;
      pose.map_base_position[0] = i < 40 ? 0.1 * std::max(i - 20, 0) : 7;  // stands for 2 s
      if (i == 40) {
        corrected.utime = pose.utime;
        corrected.epoch = 2;
        corrected.num_pages = 1;
        for (int k : {0, 21, 25, 30, 35, 39}) {
          corrected.utimes.push_back(kBegin + k * 100'000);
          corrected.revolutions.push_back(k);
          corrected.positions.push_back({5 + 0.1F * static_cast<float>(std::max(k - 20, 0)), 0, 0});
          corrected.orientations.push_back({1, 0, 0, 0});
        }
        corrected.num_poses = static_cast<std::int32_t>(corrected.utimes.size());
        write(log, "MAP_TRAJECTORY", corrected, pose.utime);
      }
      write(log, "MAP_POSE", pose);
    }
  }
  EXPECT_EQ(run({"pcd", path("poses.lcmlog"), "--merged", "--out", path("all.pcd")}), 0) << err_;
  EXPECT_THAT(out_, HasSubstr("41 points in map, 0 without a pose left out"));
  const std::vector<float> values = floats_of(path("all.pcd"));
  ASSERT_EQ(values.size(), 41 * 6U);
  EXPECT_NEAR(values[10 * 6], 1 + 5, 0.06) << "while it stood";
  EXPECT_NEAR(values[33 * 6], 1 + 5 + 1.3, 1e-4) << "corrected";
}

TEST_F(LogTables, MergedScansStandWhereTheRecordedVehicleHadItsLidar) {
  const std::string log = points("poses.lcmlog", true, "mapper:\n  vehicle:\n    lidar: [0, 0, 0.5, 0, 0, 0]\n");
  EXPECT_EQ(run({"pcd", log, "--merged", "--out", path("all.pcd")}), 0) << err_;
  EXPECT_THAT(out_, HasSubstr("T_base_lidar: [0, 0, 0.5, 0, 0, 0]"));
  EXPECT_EQ(floats_of(path("all.pcd"))[6 + 2], 6 + 0.5);
  EXPECT_EQ(run({"pcd", log, "--merged", "--lidar", "0,0,2,0,0,0", "--out", path("all.pcd"), "--force"}), 0) << err_;
  EXPECT_EQ(floats_of(path("all.pcd"))[6 + 2], 6 + 2) << "what the user says holds";
}

}  // namespace
}  // namespace curbstone::log_tool
