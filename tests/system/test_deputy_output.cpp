#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tests/system/run_program.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::system_test {
namespace {

using ::testing::HasSubstr;

/// A group was renamed, and a script was not: as in many files of real robots.
TEST(DeputyOutput, SaysWhichScriptCannotBeRunAndRunsTheRest) {
  const test::TemporaryFolder folder;
  write_file(folder / "test.cfg",
             "script \"old\" { start group \"gone\"; }\n"
             "cmd \"a\" { exec = \"echo it runs\"; deputy = \"d\"; }\n");
  const auto result = run_program(
      fmt::format("curbstone-deputy --start-all --exit-when a --config {}/test.cfg", folder.path().string()));
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("deputy: script \"old\" cannot be run: "));
  EXPECT_THAT(result.out, HasSubstr("test.cfg:1: script \"old\": there is no group \"gone\""));
  EXPECT_THAT(result.out, HasSubstr("a: it runs"));
}

/// Debian mounts a disk with errors read-only.
TEST(DeputyOutput, ALogFolderOnAReadOnlyDiskIsAFaultAndTheVehicleDrives) {
  const test::TemporaryFolder folder;
  if (run_program("unshare -m true").exit_status != 0) GTEST_SKIP() << "may not mount";
  write_file(folder / "test.cfg", "cmd \"a\" { exec = \"sh -c 'echo it runs; sleep 3'\"; deputy = \"d\"; }\n");
  const auto result = run_program(
      fmt::format("unshare -m sh -c 'mount -t tmpfs -o ro none /mnt && exec curbstone-deputy --start-all --exit-when a "
                  "--log-dir /mnt/log --config {}/test.cfg'",
                  folder.path().string()));
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("a: it runs"));
  EXPECT_THAT(result.out + result.err, HasSubstr("what the command prints is kept in memory only"));
}

TEST(DeputyOutput, WhatASecondSignalKilledHasNotFailedToStop) {
  const test::TemporaryFolder folder;
  write_file(folder / "test.cfg",
             "cmd \"slow\" { exec = \"sh -c 'trap : INT TERM; while :; do sleep 1; done'\"; deputy = \"d\"; "
             "stop_time_allowed = 20; }\n");
  const auto result = run_program(fmt::format(
      "sh -c 'curbstone-deputy --start-all --config {}/test.cfg & d=$!; sleep 2; kill $d; sleep 1; kill $d; "
      "wait $d'",
      folder.path().string()));
  EXPECT_THAT(result.out, HasSubstr("deputy: killing what is left"));
  EXPECT_THAT(result.out, HasSubstr("slow ended: Killed after"));
  EXPECT_THAT(result.out, ::testing::Not(HasSubstr("it did not stop")));
}

/// Ctrl-S in its terminal, `| less`, a connection that stalls.
TEST(DeputyOutput, TheVehicleDoesNotWaitForWhoReadsIt) {
  const test::TemporaryFolder folder;
  write_file(folder / "test.cfg",
             "cmd \"talker\" { exec = \"sh -c 'yes | head -c 5000000; sleep 100'\"; deputy = \"d\"; }\n"
             "cmd \"end\" { exec = \"sh -c 'sleep 3'\"; deputy = \"d\"; }\n");
  run_program(fmt::format("sh -c '(timeout 15 curbstone-deputy --start-all --exit-when end --config {0}/test.cfg; "
                          "echo $? >{0}/status) 2>&1 | sleep 16'",
                          folder.path().string()),
              40);
  EXPECT_EQ(read_file(folder / "status"), "0\n") << "124: it was still waiting for its reader";
}

/// The deputy gives each command a terminal, and keeps what it prints in files.
TEST(DeputyOutput, OfTheLidarHasItsNameAndNoColours) {
  const test::TemporaryFolder folder;
  write_file(
      folder / "test.cfg",
      "cmd \"lidar\" { exec = \"timeout 2 curbstone-lidar --set host_address=203.0.113.1\"; deputy = \"d\"; }\n");
  run_program(fmt::format("curbstone-deputy --start-all --exit-when lidar --log-dir {0} --config {0}/test.cfg",
                          folder.path().string()));
  const std::string log = read_file(folder / "lidar.log");
  EXPECT_THAT(log, HasSubstr("it is tried again until it can be opened")) << "the address is of no interface";
  EXPECT_THAT(log, ::testing::Not(HasSubstr("\x1b")));
  EXPECT_THAT(log, ::testing::Not(HasSubstr("[")));
}

}  // namespace
}  // namespace curbstone::system_test
