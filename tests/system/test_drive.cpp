#include <gmock/gmock.h>
#include <signal.h>

#include <map>
#include <utility>

#include "services/semantic_map/tile/map_types.hpp"
#include "tests/system/demo_drive.hpp"

namespace curbstone::system_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

int cells(const MapContent& map, semantic_map::tile::CellClass cell) {
  return map.cells[static_cast<std::size_t>(cell)];
}

/// What a street looks like: pavement and carriageway, the kerbs along them, and what stands beside.
void expect_a_street(const MapContent& map) {
  EXPECT_EQ(map.integrity, "ok");
  EXPECT_GT(map.tiles, 50);
  EXPECT_GT(cells(map, semantic_map::tile::CellClass::kRoad), 3000);
  EXPECT_GT(cells(map, semantic_map::tile::CellClass::kCurb), 150);
  EXPECT_LT(cells(map, semantic_map::tile::CellClass::kCurb), cells(map, semantic_map::tile::CellClass::kRoad) / 4);
  EXPECT_GT(cells(map, semantic_map::tile::CellClass::kObstacle) + cells(map, semantic_map::tile::CellClass::kWall),
            100);
  EXPECT_GT(map.curb_lines, 2);
}

/// The last claim of a test: what a busy machine lost is no fault of theirs.
void expect_agreement(const DemoDrive& drive, const std::string& replayed, double least, const char* because) {
  const double agrees = agreement(drive.map_file(), replayed);
  const std::string spoiled = drive.spoiled_by();
  if (!spoiled.empty() && agrees <= least)
    GTEST_SKIP() << "the maps agree in " << agrees << " of the cells, but " << spoiled << ", and lost was "
                 << ::testing::PrintToString(drive.losses());
  EXPECT_GT(agrees, least) << because;
}

const std::vector<std::string> kServices = {"lidar",           "imu",         "encoder", "ekf", "mapper",
                                            "tensor_voting:1", "semantic_map"};

TEST(Drive, OfTheRealProcessesEndsWithAStreetWithCurbs) {
  DemoDrive drive("--town --seed 1 --seconds 12");
  ASSERT_TRUE(drive.wait_for_scans(100)) << drive.output();
  std::map<std::string, std::string> unwell;  // when fewest were
  drive.bus.wait_until(
      [&, looked = false]() mutable {
        auto now = drive.unwell(kServices);
        if (!std::exchange(looked, true) || now.size() < unwell.size()) unwell = std::move(now);
        return unwell.empty();
      },
      20);
  EXPECT_EQ(drive.wait_for_end(), 0) << drive.output();
  expect_a_street(drive.map());
  EXPECT_GT(drive.pose.map_base_position[0], 10.0) << "it has driven down the street";
  EXPECT_LT(drive.driven_until_seen.value_or(100), 0.05) << "the map is of what it saw while it still stood";
  EXPECT_THAT(drive.output(), Not(HasSubstr("killed")));

  const std::string spoiled = drive.spoiled_by();
  const std::vector<std::string> lost = drive.losses();
  const std::string again = drive.replay();
  const auto same = run_program("curbstone evaluate --map " + drive.map_file() + " --against " + again);
  if (!spoiled.empty() && same.exit_status != 0)
    GTEST_SKIP() << "the recording gives another map, but " << spoiled << ", and lost was "
                 << ::testing::PrintToString(lost);
  EXPECT_EQ(same.exit_status, 0) << "the recording gives the live map, bit for bit, but: " << same.out << same.err;
  const double first_tile = drive.driven_until_first_tile.value_or(100);
  if (!spoiled.empty() && !(unwell.empty() && first_tile < 0.05 && lost.empty()))
    GTEST_SKIP() << "the recording gives the live map, but " << spoiled << "; unwell were "
                 << ::testing::PrintToString(unwell) << ", the first tile was heard after " << first_tile
                 << " m, and lost was " << ::testing::PrintToString(lost);
  EXPECT_THAT(unwell, ::testing::IsEmpty()) << "a service is silent, or has a fault in good weather";
  EXPECT_LT(first_tile, 0.05) << "the map is shown while the vehicle still stands";
  EXPECT_THAT(lost, ElementsAre());
}

/// Each device that scripts/demo offers is on some vehicle.
class DriveWithOtherDevices : public ::testing::TestWithParam<DemoDevices> {};

TEST_P(DriveWithOtherDevices, EndsWithAStreetWithCurbsAndNoFault) {
  DemoDrive drive("--town --seed 1 --seconds 12", "", GetParam());
  ASSERT_TRUE(drive.wait_for_scans(100)) << drive.output();
  std::map<std::string, std::string> unwell;
  const bool all_well = drive.bus.wait_until([&] { return (unwell = drive.unwell(kServices)).empty(); }, 20);
  EXPECT_EQ(drive.wait_for_end(), 0) << drive.output();
  expect_a_street(drive.map());
  EXPECT_GT(drive.pose.map_base_position[0], 10.0) << "it has driven down the street";
  const std::string spoiled = drive.spoiled_by();
  if (!spoiled.empty() && !all_well) GTEST_SKIP() << spoiled << "; " << ::testing::PrintToString(unwell);
  EXPECT_TRUE(all_well) << ::testing::PrintToString(unwell);
}
INSTANTIATE_TEST_SUITE_P(On, DriveWithOtherDevices,
                         ::testing::Values(DemoDevices{.encoder = "modbus", .lidar = "helios16p"},
                                           DemoDevices{.lidar = "vlp16"},
                                           DemoDevices{.imu = "witmotion", .lidar = "helios32"}),
                         [](const auto& devices) { return devices.param.lidar; });

TEST(Drive, AVotingWorkerKilledMidDriveComesBackAndTheMapConverges) {
  DemoDrive drive("--town --seed 1 --seconds 12", "--settle 15");
  ASSERT_TRUE(drive.wait_for_scans(120)) << drive.output();
  EXPECT_TRUE(drive.kill_and_see_it_come_back("tensor_voting:1")) << drive.output();
  EXPECT_EQ(drive.wait_for_end(), 0) << drive.output();
  expect_a_street(drive.map());

  const std::string replayed = drive.replay();  // without that accident
  expect_agreement(drive, replayed, 0.95, "what a cell's class turns on, live pacing may shift a little");
}

TEST(Drive, AMapperKilledMidDriveComesBackAndTheMapHoldsTheWholeDrive) {
  DemoDrive drive("--town --seed 1 --seconds 12", "--settle 15");
  ASSERT_TRUE(drive.wait_for_scans(160)) << drive.output();
  const map_pose_t before = drive.pose;
  ASSERT_TRUE(drive.kill_and_see_it_come_back("mapper")) << drive.output();
  ASSERT_TRUE(drive.bus.wait_until([&] { return drive.pose.epoch != before.epoch; }, 20)) << "it does not go on";
  EXPECT_TRUE(drive.bus.wait_until([&] { return drive.pose.map_base_position[0] > before.map_base_position[0]; }, 20))
      << "in the frame of before, after what was missed has been mapped";
  EXPECT_TRUE(drive.bus.wait_until([&] { return drive.bus.counter("mapper", "resumed") == 1; }, 20)) << drive.output();
  EXPECT_EQ(drive.wait_for_end(), 0) << drive.output();
  EXPECT_FALSE(drive.bus.has_fault("semantic_map", "mid-drive")) << "it is the same drive";
  expect_a_street(drive.map());
  EXPECT_EQ(drive.map_files(), 1) << "one drive, one map";

  const std::string replayed = drive.replay();  // without that accident
  expect_agreement(drive, replayed, 0.95, "a map begun anew has another frame");
}

TEST(Drive, AMapperThatStoodStillForSecondsKnowsWhereItIsAndMapsOn) {
  DemoDrive drive("--town --seed 1 --seconds 15", "--settle 15");
  ASSERT_TRUE(drive.wait_for_scans(160)) << drive.output();
  const double before = drive.pose.map_base_position[0];
  const int pid = drive.bus.pid("mapper");
  ASSERT_GT(pid, 0);
  ASSERT_EQ(kill(pid, SIGSTOP), 0);
  EXPECT_TRUE(drive.bus.wait_until([&] { return drive.bus.has_fault("tensor_voting:1", "the mapper is silent"); }, 20));
  ASSERT_EQ(kill(pid, SIGCONT), 0);
  EXPECT_TRUE(drive.bus.wait_until([&] { return drive.bus.is_healthy("tensor_voting:1"); }, 20));
  EXPECT_EQ(drive.wait_for_end(), 0) << drive.output();
  EXPECT_EQ(drive.bus.counter("mapper", "lost.blind"), 0) << "odometry on both sides of the gap agrees with the LiDAR";
  EXPECT_GT(drive.pose.map_base_position[0], before + 3.0);
  expect_a_street(drive.map());

  const std::string replayed = drive.replay();  // without that accident
  expect_agreement(drive, replayed, 0.9, "what it saw of those seconds is missing, nothing is displaced");
}

TEST(Drive, AnEkfKilledMidDriveComesBackAndMappingGoesOn) {
  DemoDrive drive("--town --seed 1 --seconds 14");
  ASSERT_TRUE(drive.wait_for_scans(120)) << drive.output();
  ASSERT_TRUE(drive.kill_and_see_it_come_back("ekf")) << drive.output();
  EXPECT_TRUE(drive.bus.wait_until([&] { return drive.bus.is_healthy("ekf"); }, 20)) << "it starts on the move";
  const double before = drive.pose.map_base_position[0];
  EXPECT_EQ(drive.wait_for_end(), 0) << drive.output();
  EXPECT_GT(drive.pose.map_base_position[0], before + 3.0) << "the vehicle still moves in the map";
  EXPECT_NE(drive.pose.flags & map_pose_t::REGISTERED, 0);
  expect_a_street(drive.map());
}

TEST(Drive, SensorsThatFallSilentOrSendGarbageAreFaultsThatPass) {
  DemoDrive drive(
      "--town --seed 1 --seconds 17 --fault lidar-silent:3-5.8 --fault imu-silent:6.2-8.7 --fault "
      "wheels-silent:9.5-11.5 "
      "--fault lidar-garbage:12-13 --fault imu-garbage:12-13 --fault wheels-garbage:12-13");
  ASSERT_TRUE(drive.wait_for_scans(20)) << drive.output();
  for (const char* service : {"lidar", "imu", "encoder"}) {
    EXPECT_TRUE(drive.bus.wait_until([&] { return drive.bus.has_fault(service); }, 60)) << service;
    EXPECT_TRUE(drive.bus.wait_until([&] { return drive.bus.is_healthy(service); }, 60)) << service << " recovers";
  }
  const std::vector<std::string> all = {"lidar", "imu", "encoder", "ekf", "mapper"};
  EXPECT_TRUE(drive.bus.wait_until([&] { return drive.revolutions > 225; }, 60)) << "the garbage is over";
  for (const std::string& service : all) {
    EXPECT_TRUE(drive.bus.wait_until([&] { return drive.bus.is_healthy(service); }, 20)) << service;
    EXPECT_NE(drive.bus.command(service), nullptr);
  }
  EXPECT_EQ(drive.wait_for_end(), 0) << drive.output();
  for (const std::string& service : all) {
    EXPECT_THAT(drive.output(), HasSubstr(service + " ended: exit status 0")) << "it lived through all of it";
    EXPECT_THAT(drive.output(), Not(HasSubstr(service + " ended: Se")));
  }
  expect_a_street(drive.map());
}

}  // namespace
}  // namespace curbstone::system_test
