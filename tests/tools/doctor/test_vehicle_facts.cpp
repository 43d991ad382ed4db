#include "tools/doctor/facts/vehicle_facts.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sched.h>
#include <sys/mount.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "config/sections.hpp"
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

TEST_F(VehicleFacts, AnAddressThatNoInterfaceHasIsSeen) {
  const auto address_of = [&](const std::string& yaml) { return read(yaml, "").facts.addresses.front(); };
  EXPECT_TRUE(address_of("lidar: {model: rs16}").is_ours) << "0.0.0.0: any";
  EXPECT_TRUE(address_of("lidar: {host_address: 127.0.0.1}").is_ours);
  EXPECT_FALSE(address_of("lidar: {host_address: 203.0.113.1}").is_ours);
  EXPECT_TRUE(address_of("lidar: {host_address: 203.0.113.1}").is_address);
  EXPECT_FALSE(address_of("lidar: {host_address: eth0}").is_address);
  const auto both = read("viewer: {address: localhost}", "").facts.addresses;
  ASSERT_EQ(both.size(), 2U);
  EXPECT_EQ(both[1].setting, "viewer.address");
  EXPECT_FALSE(both[1].is_address);
}

TEST_F(VehicleFacts, AWrongKeyOnACommandLineIsAFinding) {
  const auto wishes =
      read("imu: {baud: 115200}", R"(cmd "imu" { exec = "curbstone-imu --set devise=/dev/imu"; deputy = "d"; })");
  EXPECT_THAT(wishes.facts.configs, Contains(::testing::Field(&checks::ConfigFacts::error, HasSubstr("devise"))));
}

TEST_F(VehicleFacts, AServiceThatRunsWithAnOlderFileIsNamed) {
  const std::string commands =
      R"(cmd "ekf" { exec = "curbstone-ekf --config $CURBSTONE_CONFIG --set fuse_map=true"; deputy = "d"; })";
  const auto before = read("vehicle: {track_width: 0.8}", commands).config_hashes;
  ASSERT_TRUE(before.contains("ekf"));
  const auto now = read("vehicle: {track_width: 0.9}", commands);
  EXPECT_THAT(stale_services(read("vehicle: {track_width: 0.8}", commands), "ugv.yaml", before), ::testing::IsEmpty());
  const auto stale = stale_services(now, "ugv.yaml", before);
  ASSERT_EQ(stale.size(), 1U);
  EXPECT_EQ(stale[0].service, "ekf");
  EXPECT_THAT(stale_services(now, "ugv.yaml", {{"ekf", now.config_hashes.at("ekf")}, {"gnss", "x"}}),
              ::testing::IsEmpty());
}

TEST_F(VehicleFacts, NothingIsSaidOfServicesWhoseSettingsTheFilesDoNotTell) {
  const auto wishes = read("vehicle: {track_width: 0.8}", R"(
    cmd "ekf" { exec = "curbstone-ekf --config /other.yaml"; deputy = "d"; }
    cmd "imu" { exec = "sh -c 'exec curbstone-imu $OPTIONS'"; deputy = "d"; }
    cmd "lidar" { exec = "curbstone-lidar"; deputy = "d"; }
    cmd "lidar:2" { exec = "curbstone-lidar --name lidar:2"; deputy = "d"; })");
  EXPECT_THAT(wishes.config_hashes, ::testing::IsEmpty());
}

TEST_F(VehicleFacts, AnErrorOfTheSharedSectionIsSaidOnce) {
  const auto wishes = read("vehicle: {wheel_radius: 9}", "");
  const auto is_said = ::testing::Field(&checks::ConfigFacts::error, HasSubstr("ugv.yaml:1: vehicle.wheel_radius: "));
  EXPECT_THAT(wishes.facts.configs, Contains(is_said).Times(1));
}

/// Each section that a program of the vehicle reads; `simulate` is no part of it.
TEST_F(VehicleFacts, AWrongKeyOfAnySectionIsAFinding) {
  for (const std::string_view section : kProcessSections) {
    if (section == "simulate") continue;
    const auto wishes = read(fmt::format("{}:\n  no_such_key: 1\n", section), "");
    const auto is_said = Contains(::testing::Field(&checks::ConfigFacts::error, HasSubstr("ugv.yaml:2: ")));
    EXPECT_THAT(wishes.facts.configs, is_said) << section;
  }
}

checks::FolderFacts recorder_folder(const VehicleWishes& wishes) {
  const auto& folders = wishes.facts.folders;
  const auto it = std::ranges::find(folders, "recorder.folder", &checks::FolderFacts::setting);
  return it == folders.end() ? checks::FolderFacts{} : *it;
}

TEST_F(VehicleFacts, AReadOnlyFileSystemIsToldFromTheFolderOfAnotherUser) {
  const std::string here = folder_ / ".";
  EXPECT_FALSE(recorder_folder(read("recorder: {folder: " + here + "}", "")).is_read_only);
  const std::filesystem::path mounted = folder_ / "disk";
  std::filesystem::create_directory(mounted);
  if (unshare(CLONE_NEWNS) != 0 || mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
      mount("tmpfs", mounted.c_str(), "tmpfs", MS_RDONLY, nullptr) != 0)
    GTEST_SKIP() << "this user may not mount";
  const checks::FolderFacts disk = recorder_folder(read("recorder: {folder: " + mounted.string() + "}", ""));
  EXPECT_TRUE(disk.is_there);
  EXPECT_TRUE(disk.is_read_only);
  umount(mounted.c_str());
}

TEST_F(VehicleFacts, AFolderThatCannotBeLookedAtIsNotThere) {
  std::filesystem::create_symlink("loop", folder_ / "loop");
  EXPECT_FALSE(recorder_folder(read("recorder: {folder: " + (folder_ / "loop").string() + "}", "")).is_there);
}

}  // namespace
}  // namespace curbstone::doctor::facts
