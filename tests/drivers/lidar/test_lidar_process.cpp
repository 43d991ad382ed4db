#include <gmock/gmock.h>
#include <sys/wait.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "drivers/lidar/sources/udp_source.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::lidar {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

struct Ended {
  int status;
  std::string output;
};

/// Runs the program to its end, at most `seconds`, after which it gets SIGTERM.
Ended lidar(const std::string& arguments, int seconds = 20) {
  const std::string command = "timeout --preserve-status " + std::to_string(seconds) +
                              " " CURBSTONE_BIN_DIR "/curbstone-lidar " + arguments + " 2>&1";
  FILE* pipe = popen(command.c_str(), "r");
  std::string output;
  for (int c = fgetc(pipe); c != EOF; c = fgetc(pipe)) output.push_back(static_cast<char>(c));
  const int status = pclose(pipe);
  return {WEXITSTATUS(status), output};
}

TEST(LidarProcess, SaysThatItsPortIsTaken) {
  const sources::UdpSource other(6699, {});
  const Ended ended = lidar("");
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.output, HasSubstr("lidar: port 6699 is in use by another process"));
}

TEST(LidarProcess, SaysThatACaptureIsMissingOrCutOff) {
  Ended ended = lidar("--set pcap=/nowhere/drive.pcap");
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.output, HasSubstr("/nowhere/drive.pcap: No such file"));

  const std::string recorded = CURBSTONE_DATA_DIR "/rs16/rs16_washing_house.pcap";
  if (!std::filesystem::exists(recorded)) GTEST_SKIP() << recorded << " is not there";
  const testing::TemporaryFolder folder;
  const std::string cut = folder / "cut.pcap";
  std::filesystem::copy_file(recorded, cut);
  std::filesystem::permissions(cut, std::filesystem::perms::owner_all);
  std::filesystem::resize_file(cut, 100'000);
  ended = lidar("--set pcap=" + cut + " --set pcap_rate=50");
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.output, HasSubstr("truncated"));
}

TEST(LidarProcess, EndsWithACapture) {
  const std::string recorded = CURBSTONE_DATA_DIR "/rs16/rs16_washing_house.pcap";
  if (!std::filesystem::exists(recorded)) GTEST_SKIP() << recorded << " is not there";
  const Ended ended = lidar("--set pcap=" + recorded + " --set pcap_rate=20");
  EXPECT_EQ(ended.status, 0);
  EXPECT_THAT(ended.output, HasSubstr("end of the capture after 3040 packets"));
}

TEST(LidarProcess, BeginsACaptureAnewUntilItIsStopped) {
  const std::string recorded = CURBSTONE_DATA_DIR "/rs16/rs16_washing_house.pcap";
  if (!std::filesystem::exists(recorded)) GTEST_SKIP() << recorded << " is not there";
  // The recording lasts 4 s: at 100 times that pace it is through long before the 3 s.
  const std::string command = "timeout 3 " CURBSTONE_BIN_DIR "/curbstone-lidar --set pcap=" + recorded +
                              " --set pcap_rate=100 --set pcap_repeat=true > /dev/null 2>&1";
  const int status = std::system(command.c_str());
  EXPECT_EQ(WEXITSTATUS(status), 124) << "ended by itself";
}

TEST(LidarProcess, NamesTheSectionThatAnOldFileMeans) {
  const testing::TemporaryFolder folder;
  const std::string file = folder / "old.yaml";
  std::ofstream(file) << "rslidar:\n  msop_port: 6699\n";
  const Ended ended = lidar("--config " + file);
  EXPECT_EQ(ended.status, 2);
  EXPECT_THAT(ended.output, AllOf(HasSubstr("old.yaml:1: rslidar"), HasSubstr("did you mean lidar?")));
}

TEST(LidarProcess, WaitsForAnInterfaceThatIsNotThereYet) {
  // 192.0.2.9 (for documentation, RFC 5737) comes to this namespace's loopback while the process runs. Where that is
  // not allowed there is nothing to see.
  if (std::system("ip address add 192.0.2.8/32 dev lo 2>/dev/null") != 0) GTEST_SKIP() << "no network namespace";
  (void)!std::system("( sleep 1; ip address add 192.0.2.9/32 dev lo ) &");
  const Ended ended = lidar("--set host_address=192.0.2.9 --set msop_port=46701 --set difop_port=46702", 6);
  EXPECT_EQ(ended.status, 0) << "SIGTERM ends it, and nothing else did";
  EXPECT_THAT(ended.output, AllOf(HasSubstr("no interface with address 192.0.2.9"), HasSubstr("it is tried again"),
                                  HasSubstr("the interface is there: listening")));
}

TEST(LidarProcess, EndsForAnAddressThatIsNone) {
  const Ended ended = lidar("--set host_address=lidar");
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.output, HasSubstr("'lidar' is no IPv4 address"));
}

TEST(LidarProcess, RefusesConfigurationItDoesNotKnow) {
  const Ended ended = lidar("--set msop_prot=6699");
  EXPECT_EQ(ended.status, 2);
  EXPECT_THAT(ended.output, AllOf(HasSubstr("msop_prot"), HasSubstr("msop_port")));
}

}  // namespace
}  // namespace curbstone::lidar
