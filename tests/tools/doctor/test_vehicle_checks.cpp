#include <gmock/gmock.h>

#include "tools/doctor/checks/vehicle_checks.hpp"

namespace curbstone::doctor::checks {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Kind = Verdict::Kind;

Verdict only(const VehicleFacts& facts) {
  const Verdicts verdicts = check_vehicle(facts);
  EXPECT_EQ(verdicts.size(), 1U);
  return verdicts.empty() ? Verdict{} : verdicts.front();
}

VehicleFacts of_user() {
  VehicleFacts facts;
  facts.user = "curbstone";
  return facts;
}

TEST(VehicleChecks, AFileThatDoesNotParseIsNamedWithItsError) {
  VehicleFacts facts = of_user();
  facts.configs = {{"ugv.yaml", "ugv.yaml:9: mapper: stands in line 4 already"}};
  EXPECT_EQ(only(facts).kind, Kind::kFinding);
  EXPECT_EQ(only(facts).what, "ugv.yaml:9: mapper: stands in line 4 already");
  facts.configs[0].error.clear();
  EXPECT_EQ(only(facts).kind, Kind::kGood);
}

TEST(VehicleChecks, AServiceWithOtherSettingsThanTheFilesIsRestarted) {
  VehicleFacts facts = of_user();
  facts.stale = {{"mapper", "ugv.yaml"}};
  EXPECT_EQ(only(facts).kind, Kind::kFinding);
  EXPECT_EQ(only(facts).what, "mapper runs with other settings than ugv.yaml and the procman file have now");
  EXPECT_THAT(only(facts).fix, HasSubstr("curbstone-sheriff restart mapper"));
}

TEST(VehicleChecks, OnlyMissingProgramsAreNamed) {
  VehicleFacts facts = of_user();
  facts.programs = {{"imu", "curbstone-imu", true}};
  EXPECT_THAT(check_vehicle(facts), IsEmpty());
  facts.programs = {{"gnss", "curbstone-gnss", false}};
  EXPECT_EQ(only(facts).what, "gnss: there is no program curbstone-gnss");
}

TEST(VehicleChecks, AFolderIsThereAndWritable) {
  VehicleFacts facts = of_user();
  facts.folders = {{"recorder.file", "/data", true, true, false}};
  EXPECT_EQ(only(facts).kind, Kind::kGood);
  facts.folders[0].is_writable = false;
  EXPECT_EQ(only(facts).fix, "chown curbstone /data");
  facts.folders[0].is_there = false;
  EXPECT_EQ(only(facts).fix, "install -d -o curbstone /data");
}

/// `chown` would not help: ProtectSystem=strict and ProtectHome=true of the unit.
TEST(VehicleChecks, AFolderThatSystemdKeepsFromTheUnitIsOpenedByADropIn) {
  VehicleFacts facts = of_user();
  facts.folders = {{"recorder.folder", "/data", true, false, true}};
  EXPECT_EQ(only(facts).what, "recorder.folder: /data is on a read-only file system");
  EXPECT_THAT(only(facts).fix, HasSubstr("systemctl edit curbstone-deputy: [Service] ReadWritePaths=/data"));
  facts.folders = {{"semantic_map.map", "/home/ugv/maps", false, false, false}};
  EXPECT_THAT(only(facts).what, HasSubstr("is not there, or hidden from a unit of systemd"));
  EXPECT_THAT(only(facts).fix, HasSubstr("ProtectHome=no"));
}

TEST(VehicleChecks, ADeviceIsThereAndMayBeOpened) {
  VehicleFacts facts = of_user();
  facts.devices = {{"imu.device", "/dev/ttyUSB0", true, true, "dialout"}};
  EXPECT_EQ(only(facts).kind, Kind::kGood);
  facts.devices[0].is_usable = false;
  EXPECT_THAT(only(facts).fix, HasSubstr("usermod -aG dialout curbstone"));
  facts.devices[0].is_there = false;
  EXPECT_THAT(only(facts).what, HasSubstr("/dev/ttyUSB0 is not there"));
}

TEST(VehicleChecks, AnAddressToListenAtIsOfThisHost) {
  VehicleFacts facts = of_user();
  facts.addresses = {{"lidar.host_address", "192.168.1.102", true, true}};
  EXPECT_EQ(only(facts).kind, Kind::kGood);
  facts.addresses[0].is_ours = false;
  EXPECT_EQ(only(facts).what, "lidar.host_address: no interface has 192.168.1.102");
  EXPECT_THAT(only(facts).fix, HasSubstr("ip address add 192.168.1.102/24 dev"));
  facts.addresses = {{"lidar.host_address", "eth0", false, false}};
  EXPECT_EQ(only(facts).what, "lidar.host_address: 'eth0' is no address");
}

TEST(VehicleChecks, ACanInterfaceIsUpWithTheBitRateOfTheDrive) {
  VehicleFacts facts = of_user();
  facts.can_bitrate = 500'000;
  facts.can = CanFacts{"can0", true, true, 500'000, "ERROR-ACTIVE"};
  EXPECT_EQ(only(facts).kind, Kind::kGood);
  facts.can->bitrate = 250'000;
  EXPECT_EQ(only(facts).what, "can0 has 250000 bit/s, encoder.bitrate is 500000");
  facts.can->bitrate = 500'000;
  facts.can->state = "BUS-OFF";
  EXPECT_THAT(only(facts).what, HasSubstr("BUS-OFF"));
  facts.can->is_up = false;
  EXPECT_THAT(only(facts).fix, HasSubstr("ip link set can0 up type can bitrate 500000"));
  facts.can->is_there = false;
  EXPECT_EQ(only(facts).what, "can0 is not there");
}

LidarFacts lidar(const std::string& sender, std::int64_t packets) {
  LidarFacts facts;
  facts.port = 6699;
  facts.listened = true;
  facts.seconds = 2;
  if (packets > 0) facts.packets[sender] = packets;
  return facts;
}

TEST(VehicleChecks, TheLidarSendsToItsPort) {
  VehicleFacts facts = of_user();
  facts.lidar = lidar("192.168.1.200", 1500);
  EXPECT_EQ(only(facts).what, "750 packets/s on port 6699");
  facts.lidar->wanted_sender = "192.168.1.201";
  EXPECT_EQ(only(facts).what, "192.168.1.200 sends to port 6699, not 192.168.1.201");
  facts.lidar = lidar("", 0);
  EXPECT_EQ(only(facts).kind, Kind::kFinding);
}

TEST(VehicleChecks, ALidarThatSendsToAnotherPortIsNamed) {
  VehicleFacts facts = of_user();
  facts.lidar = lidar("", 0);
  facts.lidar->elsewhere = {{"port 2368, from 192.168.1.201", 1500}, {"port 9000, from 192.168.1.7", 3}};
  EXPECT_EQ(only(facts).what,
            "no packet on port 6699, but 750 a second of a LiDAR's size to port 2368, from 192.168.1.201");
  EXPECT_THAT(only(facts).fix, HasSubstr("lidar.msop_port"));
}

TEST(VehicleChecks, WhereADriverHasThePortItsMessagesCount) {
  VehicleFacts facts = of_user();
  facts.lidar = lidar("", 0);
  facts.lidar->listened = false;
  EXPECT_EQ(only(facts).kind, Kind::kUnknown);
  facts.lidar->messages = 700;
  EXPECT_EQ(only(facts).kind, Kind::kGood);
}

TEST(VehicleChecks, TheDiskIsMeasuredInHoursOfRecording) {
  VehicleFacts facts = of_user();
  facts.disk = DiskFacts{"/data", 36'000'000'000, 10e6, true};
  EXPECT_EQ(only(facts).what, "1.0 h of recording are free in /data, at 10.0 MB/s (measured)");
  EXPECT_EQ(only(facts).kind, Kind::kGood);
  facts.disk->free_bytes = 3'600'000'000;
  EXPECT_EQ(only(facts).kind, Kind::kFinding);
}

}  // namespace
}  // namespace curbstone::doctor::checks
