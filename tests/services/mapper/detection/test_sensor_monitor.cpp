#include "services/mapper/detection/sensor_monitor.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "common/bus/local_bus.hpp"
#include "services/mapper/mapper_node.hpp"
#include "tests/drivers/lidar/bench.hpp"
#include "tests/paths.hpp"
#include "tests/services/mapper/detection_scans.hpp"

namespace curbstone::mapper::detection {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<std::string> faults_of(const SensorMonitor& monitor) {
  std::vector<std::string> faults;
  monitor.add_faults(faults);
  return faults;
}

TEST(SensorMonitor, ALaserThatIsWrongWhileTheVehicleStandsNeverReachesTheDrivesMap) {
  LocalBus bus;
  MapperNode node({}, bus);
  node.connect(bus);
  test::DetectionScans drive;
  for (int i = 0; i < 60; ++i) {
    for (lidar_points_t& packet :
         drive.world.packets(drive.trajectory, drive.T_base_lidar, i, i * test::kPeriod, test::kPeriod)) {
      for (std::size_t k = 0; k < packet.x.size(); ++k) {
        if (packet.ring[k] == 2) packet.z[k] += 0.08F;
      }
      bus.publish("LIDAR_POINTS", packet);
      bus.dispatch();
    }
  }
  EXPECT_THAT(node.report().faults, Contains(HasSubstr("laser 2 (0: the lowest) looks")));
  EXPECT_GT(node.report().counters["withheld.laser"], 0);
}

TEST(SensorMonitor, AStandingVehicleThatSeesNoGroundIsAFaultOfTheMapper) {
  for (const bool sees : {true, false}) {
    LocalBus bus;
    MapperNode node({}, bus);
    node.connect(bus);
    test::DetectionScans drive;
    for (int i = 0; i < 120; ++i) {
      for (lidar_points_t& packet :
           drive.world.packets(drive.trajectory, drive.T_base_lidar, i, i * test::kPeriod, test::kPeriod)) {
        for (std::size_t k = 0; k < packet.x.size(); ++k) {
          if (!sees && packet.z[k] < -1.6F && std::hypot(packet.x[k], packet.y[k]) > 6.0F) packet.x[k] = NAN;
        }
        bus.publish("LIDAR_POINTS", packet);
        bus.dispatch();
      }
    }
    const NodeReport report = node.report();
    const auto named = HasSubstr("no ground in sight beyond 6 m");
    EXPECT_EQ(std::count_if(report.faults.begin(), report.faults.end(),
                            [&](const std::string& fault) { return ::testing::Matches(named)(fault); }),
              sees ? 0 : 1);
  }
}

/// Indoors, by a real device that stands: whatever is about it.
TEST(SensorMonitor, NothingIsWrongWithARecordedLidar) {
  const std::string file = test::data_path("rs16/rs16_washing_house.pcap");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
  lidar::Bench bench;
  for (const lidar::RecordedPacket& packet : lidar::recording(file))
    bench.send(packet.bytes, packet.received, packet.port);
  bench.finish();
  SensorMonitor monitor{VehicleConfig{}};
  scan::ScanAssembler assembler;
  int scans = 0;
  for (int turn = 0; turn < 3; ++turn) {
    for (lidar_points_t m : bench.points) {
      m.revolution += turn * 1000;
      m.packet += turn * 100'000;
      m.utime += turn * 5'000'000LL;
      std::optional<scan::Scan> scan = assembler.add(m);
      if (!scan) continue;
      const std::size_t points = scan->points.size();
      monitor.clean(*scan);
      ASSERT_EQ(scan->points.size(), points);
      ++scans;
    }
  }
  EXPECT_GT(scans, 100);
  EXPECT_THAT(faults_of(monitor), IsEmpty());
}

}  // namespace
}  // namespace curbstone::mapper::detection
