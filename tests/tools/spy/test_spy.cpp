// The command, on the bus of this test's own namespace.
#include "tools/spy/spy.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <atomic>
#include <curbstone/imu_t.hpp>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/bus/lcm_bus.hpp"
#include "common/time/clock.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::spy {
namespace {

int spy(std::vector<std::string> words, std::string& output) {
  words.insert(words.begin(), "spy");
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  const int status = run_spy(static_cast<int>(argv.size()), argv.data());
  ::testing::internal::GetCapturedStderr();
  output = ::testing::internal::GetCapturedStdout();
  return status;
}

TEST(Spy, HearsABusAndDecodesAMessage) {
  std::atomic<bool> stop = false;
  std::thread sender([&] {
    LcmBus bus;
    for (imu_t imu{}; !stop; ++imu.sequence) {
      bus.publish("IMU", imu);
      usleep(5000);
    }
  });
  std::string output;
  const int status = spy({"IMU", "--once", "--seconds", "1.5", "--json"}, output);
  stop = true;
  sender.join();
  EXPECT_EQ(status, 0);
  const auto json = nlohmann::json::parse(output);
  EXPECT_EQ(json["channels"][0]["channel"], "IMU");
  EXPECT_GT(json["channels"][0]["rate_hz"], 0);
  EXPECT_GT(json["message"]["sequence"], 0);
}

TEST(Spy, WritesATraceOfTheBus) {
  const test::TemporaryFolder folder;
  const std::string file = folder / "trace.json";
  std::atomic<bool> stop = false;
  std::thread sender([&] {
    LcmBus bus;
    for (imu_t imu{}; !stop; ++imu.sequence) {
      imu.utime = wall_clock();
      bus.publish("IMU", imu);
      usleep(5000);
    }
  });
  std::string output;
  const int status = spy({"--trace", file, "--seconds", "1.5"}, output);
  stop = true;
  sender.join();
  EXPECT_EQ(status, 0);
  EXPECT_THAT(output, ::testing::HasSubstr("spans of 1 channels"));
  const auto json = nlohmann::json::parse(std::ifstream(file));
  EXPECT_GT(json.at("traceEvents").size(), 3U);
  EXPECT_EQ(spy({"--trace", folder / "silent.json", "--seconds", "0.1"}, output), 1) << "nothing came";
  EXPECT_EQ(spy({"IMU", "--trace", file}, output), 2);
}

TEST(Spy, ASilentBusIsOneAndWrongUsageTwo) {
  std::string output;
  EXPECT_EQ(spy({"--once", "--seconds", "0.1"}, output), 1);
  EXPECT_THAT(output, ::testing::HasSubstr("nothing comes"));
  EXPECT_EQ(spy({"--json"}, output), 2);
  EXPECT_EQ(spy({"--bogus"}, output), 2);
}

}  // namespace
}  // namespace curbstone::spy
