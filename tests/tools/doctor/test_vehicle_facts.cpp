#include "tools/doctor/facts/vehicle_facts.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "tests/temporary_folder.hpp"

namespace curbstone::doctor::facts {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

class VehicleFacts : public ::testing::Test {
 protected:
  VehicleWishes read(const std::string& yaml, const std::string& commands) {
    std::ofstream(folder_ / "ugv.yaml") << yaml;
    std::ofstream(folder_ / "ugv.cfg") << commands;
    return read_vehicle(folder_ / "ugv.yaml", folder_ / "ugv.cfg");
  }
  static std::string folder_of(const VehicleWishes& wishes, const std::string& setting) {
    const auto& folders = wishes.facts.folders;
    const auto it = std::ranges::find(folders, setting, &checks::FolderFacts::setting);
    return it == folders.end() ? "none" : it->folder;
  }
  test::TemporaryFolder folder_;
};

TEST_F(VehicleFacts, TheRecorderWritesSessionsOrOneFile) {
  const auto sessions = read("recorder: {folder: /data/sessions}", "");
  EXPECT_EQ(folder_of(sessions, "recorder.folder"), "/data/sessions");
  EXPECT_EQ(sessions.recorder_folder, "/data/sessions") << "whose disk is looked at";
  const auto file = read("recorder: {file: /data/logs/drive.lcmlog}", "");
  EXPECT_EQ(folder_of(file, "recorder.file"), "/data/logs");
  EXPECT_EQ(file.recorder_folder, "/data/logs");
}

TEST_F(VehicleFacts, WhatTheCommandsSetCountsMoreThanTheFile) {
  setenv("VEHICLE_OUT", "/data/out", 1);
  const auto wishes = read("semantic_map: {map: /var/lib/map.db}\nimu: {device: /dev/ttyUSB0}", R"(
    cmd "map" { exec = "curbstone-semantic-map --nice 5 --set map=$VEHICLE_OUT/map.db"; deputy = "d"; }
    cmd "imu" { exec = "sh -c 'exec curbstone-imu --set model=xsens --set device=$VEHICLE_OUT/imu'"; deputy = "d"; }
  )");
  EXPECT_EQ(folder_of(wishes, "semantic_map.map"), "/data/out");
  EXPECT_THAT(wishes.facts.devices, Contains(::testing::Field(&checks::DeviceFacts::file, "/data/out/imu")));
}

TEST_F(VehicleFacts, AWrongKeyOnACommandLineIsAFinding) {
  const auto wishes =
      read("imu: {baud: 115200}", R"(cmd "imu" { exec = "curbstone-imu --set devise=/dev/imu"; deputy = "d"; })");
  EXPECT_THAT(wishes.facts.configs, Contains(::testing::Field(&checks::ConfigFacts::error, HasSubstr("devise"))));
}

}  // namespace
}  // namespace curbstone::doctor::facts
