#include <gmock/gmock.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdio>
#include <curbstone/lidar_points_t.hpp>
#include <filesystem>
#include <fstream>
#include <map>
#include <vector>

#include "common/bus/lcm_bus.hpp"
#include "common/time/clock.hpp"
#include "drivers/lidar/sources/udp_source.hpp"
#include "tests/drivers/lidar/captures.hpp"
#include "tests/drivers/stopped_after.hpp"
#include "tests/paths.hpp"
#include "tests/temporary_folder.hpp"
#include "tools/simulate/devices/make_lidar.hpp"

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
  const std::string command = test::kStoppedAfter + std::to_string(seconds) + " " +
                              test::program_path("curbstone-lidar") + " " + arguments + " 2>&1";
  FILE* pipe = popen(command.c_str(), "r");
  std::string output;
  for (int c = fgetc(pipe); c != EOF; c = fgetc(pipe)) output.push_back(static_cast<char>(c));
  const int status = pclose(pipe);
  return {WEXITSTATUS(status), output};
}

TEST(LidarProcess, SaysThatItsPortIsTakenAndWaitsForIt) {
  const sources::UdpSource other(6699, {});
  const Ended ended = lidar("", 3);
  EXPECT_EQ(ended.status, 0) << "until it is ended";
  EXPECT_THAT(ended.output, HasSubstr("lidar: port 6699 is in use by another process"));
}

TEST(LidarProcess, SaysThatACaptureIsMissingOrCutOff) {
  Ended ended = lidar("--set pcap=/nowhere/drive.pcap");
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.output, HasSubstr("/nowhere/drive.pcap: No such file"));

  const std::string recorded = test::data_path("rs16/rs16_washing_house.pcap");
  if (!std::filesystem::exists(recorded)) GTEST_SKIP() << recorded << " is not there";
  const test::TemporaryFolder folder;
  const std::string cut = folder / "cut.pcap";
  std::filesystem::copy_file(recorded, cut);
  std::filesystem::permissions(cut, std::filesystem::perms::owner_all);
  std::filesystem::resize_file(cut, 100'000);
  ended = lidar("--set pcap=" + cut + " --set pcap_rate=50");
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.output, HasSubstr("truncated"));
}

TEST(LidarProcess, EndsWithACapture) {
  const std::string recorded = test::data_path("rs16/rs16_washing_house.pcap");
  if (!std::filesystem::exists(recorded)) GTEST_SKIP() << recorded << " is not there";
  const Ended ended = lidar("--set pcap=" + recorded + " --set pcap_rate=20");
  EXPECT_EQ(ended.status, 0);
  EXPECT_THAT(ended.output, HasSubstr("end of the capture after 3040 packets"));
}

TEST(LidarProcess, BeginsACaptureAnewUntilItIsStopped) {
  const std::string recorded = test::data_path("rs16/rs16_washing_house.pcap");
  if (!std::filesystem::exists(recorded)) GTEST_SKIP() << recorded << " is not there";
  // The recording lasts 4 s: at 100 times that pace it is through long before the 3 s.
  const std::string command = "timeout --foreground 3 " + test::program_path("curbstone-lidar") +
                              " --set pcap=" + recorded +
                              " --set pcap_rate=100 --set pcap_repeat=true > /dev/null 2>&1";
  const int status = std::system(command.c_str());
  EXPECT_EQ(WEXITSTATUS(status), 124) << "ended by itself";
}

/// The program, until the test is over.
class RunningLidar {
 public:
  explicit RunningLidar(std::vector<std::string> words) {
    words.insert(words.begin(), test::program_path("curbstone-lidar"));
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    EXPECT_EQ(posix_spawn(&pid_, words.front().c_str(), nullptr, nullptr, arguments.data(), environ), 0);
  }
  ~RunningLidar() {
    kill(pid_, SIGTERM);
    waitpid(pid_, nullptr, 0);
  }
  RunningLidar(const RunningLidar&) = delete;
  RunningLidar& operator=(const RunningLidar&) = delete;

 private:
  pid_t pid_ = 0;
};

/// A second of an emulated device, all of whose returns are at `range`.
Capture second_of(simulate::devices::LidarName name, float range) {
  const auto device = simulate::devices::make_lidar(name, 1200);
  const auto& table = device->table();
  const std::vector<simulate::devices::LidarShot> shots(static_cast<std::size_t>(table.lasers), {range, 100});
  std::vector<Bytes> frames;
  for (int firing = 0; firing * table.firing_period < 1.0; ++firing) {
    const auto utime = 100'000'000 + static_cast<std::int64_t>(firing * table.firing_period * 1e6);
    if (const auto packet = device->add_firing(utime, firing * device->azimuth_step(), shots))
      frames.push_back(frame(*packet, table.point_port));
  }
  return Capture(frames, kEthernet, Capture::Format::kMicroseconds,
                 static_cast<std::int64_t>(table.packet_period() * 1e6));
}

TEST(LidarProcess, SharesABusWithAnotherLidarOnAChannelOfItsOwn) {
  using simulate::devices::LidarName;
  const Capture front = second_of(LidarName::kRs16, 10);
  const Capture rear = second_of(LidarName::kVlp16, 20);
  LcmBus bus;
  std::map<std::string, std::vector<double>> ranges;
  for (const char* channel : {"LIDAR_POINTS", "LIDAR_POINTS_REAR"}) {
    bus.subscribe<lidar_points_t>(channel, [&, channel](const lidar_points_t& message) {
      ASSERT_GT(message.num_points, 0);
      ranges[channel].push_back(std::hypot(static_cast<double>(message.x[0]), static_cast<double>(message.y[0]),
                                           static_cast<double>(message.z[0])));
    });
  }
  const RunningLidar first({"--set", "model=rs16", "--set", "pcap=" + front.name(), "--set", "pcap_repeat=true"});
  const RunningLidar second({"--name", "lidar:2", "--set", "model=vlp16", "--set", "channel=LIDAR_POINTS_REAR", "--set",
                             "pcap=" + rear.name(), "--set", "pcap_repeat=true"});
  const std::int64_t deadline = steady_clock() + 50'000'000;
  const auto enough = [&](const char* channel) { return ranges[channel].size() >= 100; };
  while ((!enough("LIDAR_POINTS") || !enough("LIDAR_POINTS_REAR")) && steady_clock() < deadline)
    bus.handle(std::chrono::milliseconds(100));
  using ::testing::DoubleNear;
  using ::testing::Each;
  EXPECT_TRUE(enough("LIDAR_POINTS")) << ranges["LIDAR_POINTS"].size();
  EXPECT_TRUE(enough("LIDAR_POINTS_REAR")) << ranges["LIDAR_POINTS_REAR"].size();
  EXPECT_THAT(ranges["LIDAR_POINTS"], Each(DoubleNear(10, 0.1)));
  EXPECT_THAT(ranges["LIDAR_POINTS_REAR"], Each(DoubleNear(20, 0.1)));
}

TEST(LidarProcess, NamesTheSectionThatAnOldFileMeans) {
  const test::TemporaryFolder folder;
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
                                  HasSubstr("the port is open: listening")));
}

TEST(LidarProcess, EndsForAnAddressThatIsNone) {
  const Ended ended = lidar("--set host_address=lidar");
  EXPECT_EQ(ended.status, 2);
  EXPECT_THAT(ended.output, HasSubstr("'lidar' is no IPv4 address"));
}

TEST(LidarProcess, RefusesConfigurationItDoesNotKnow) {
  const Ended ended = lidar("--set msop_prot=6699");
  EXPECT_EQ(ended.status, 2);
  EXPECT_THAT(ended.output, AllOf(HasSubstr("msop_prot"), HasSubstr("msop_port")));
}

}  // namespace
}  // namespace curbstone::lidar
