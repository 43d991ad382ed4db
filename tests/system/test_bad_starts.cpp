#include <gmock/gmock.h>

#include <chrono>
#include <memory>
#include <thread>

#include "tests/system/run_program.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::system_test {
namespace {

using ::testing::HasSubstr;

/// One line that names what is wrong. Exit status 1: the environment is not as the config says.
void expect_refused(const std::string& command, const std::string& says, int exit_status = 1) {
  const auto result = run_program(command);
  EXPECT_EQ(result.exit_status, exit_status) << command << "\n" << result.err;
  EXPECT_THAT(result.err, HasSubstr(says)) << command;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
}

TEST(BadStarts, ACaptureThatIsNotThere) {
  expect_refused("curbstone-lidar --set pcap=/nowhere/x.pcap", "/nowhere/x.pcap");
}

TEST(BadStarts, AFileThatIsNoSerialPort) {  // one that is not there is waited for: tests/drivers
  expect_refused("curbstone-imu --set device=/dev/null", "/dev/null is no serial port");
  expect_refused("curbstone-encoder --set interface=slcan --set device=/dev/null", "/dev/null is no serial port");
}

TEST(BadStarts, ANameThatIsNoCanInterfaces) {  // one that is not there is waited for: tests/drivers/encoder
  expect_refused("curbstone-encoder --set interface=socketcan --set device=/dev/ttyACM0", "/dev/ttyACM0");
}

/// No waiting mends it, so the deputy must not start them again: exit status 2.
TEST(BadStarts, WhatIsNoAddressIsAWrongConfiguration) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "ugv.yaml";
  write_file(file, "lidar: {host_address: eth0}\nviewer: {address: localhost}\nrelay: {peers: second}\n");
  expect_refused("curbstone-lidar --config " + file, "lidar: " + file + ": host_address: 'eth0' is no IPv4", 2);
  expect_refused("curbstone-viewer --config " + file, "viewer.address: 'localhost' is no address", 2);
  expect_refused("curbstone-relay --config " + file, "relay.peers: second is no IPv4 address", 2);
  expect_refused("curbstone-encoder --set interface=modbus_tcp --set modbus.host=gateway",
                 "encoder.modbus.host: 'gateway' is no IPv4", 2);
}

TEST(BadStarts, AMapThatIsNone) {  // one whose folder is not there is waited for: tests/services/semantic_map/store
  const test::TemporaryFolder folder;
  write_file(folder / "map.db", "this is a letter, not a map\n");
  expect_refused("curbstone-semantic-map --set map=" + (folder / "map.db").string(), "map.db");
  EXPECT_EQ(read_file(folder / "map.db"), "this is a letter, not a map\n") << "left as it was";
}

TEST(BadStarts, AnExporterWaitsForAPortThatAnotherHas) {
  const test::TemporaryFolder folder;
  auto first = std::make_unique<BackgroundProgram>("curbstone-exporter", folder / "first");
  const auto says = [](const BackgroundProgram& program, const std::string& what) {
    for (int i = 0; i < 200 && program.output().find(what) == std::string::npos; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    return program.output();
  };
  ASSERT_THAT(says(*first, "9750/metrics"), HasSubstr("http://127.0.0.1:9750/metrics"));
  const BackgroundProgram second("curbstone-exporter", folder / "second");
  EXPECT_THAT(says(second, "cannot listen"), HasSubstr("exporter: cannot listen at 127.0.0.1:9750"));
  first.reset();
  EXPECT_THAT(says(second, "9750/metrics"), HasSubstr("http://127.0.0.1:9750/metrics"));
}

/// Debian mounts a disk with errors read-only.
TEST(BadStarts, ARecorderWaitsForADiskThatIsReadOnly) {
  if (run_program("unshare -m true").exit_status != 0) GTEST_SKIP() << "may not mount";
  const auto result = run_program(
      "unshare -m sh -c 'mount -t tmpfs -o ro none /mnt && timeout --preserve-status 4 curbstone-recorder --set "
      "folder=/mnt/log'");
  EXPECT_EQ(result.exit_status, 0) << "it is ended by a signal";
  EXPECT_THAT(result.err, ::testing::ContainsRegex("/mnt/log/.*cannot be made: Read-only file system"));
}

}  // namespace
}  // namespace curbstone::system_test
