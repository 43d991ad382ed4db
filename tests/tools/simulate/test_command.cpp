// The command line: what is wrong is said in one line, with the right exit status.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/simulate/simulate.hpp"

namespace curbstone {
namespace {

struct Outcome {
  int status;
  std::string errors;
};

Outcome run(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "simulate");
  std::vector<char*> argv;
  for (auto& argument : arguments) argv.push_back(argument.data());
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  const int status = run_simulate(static_cast<int>(argv.size()), argv.data());
  testing::internal::GetCapturedStdout();
  return {status, testing::internal::GetCapturedStderr()};
}

const std::string kLog = testing::TempDir() + "command.lcmlog";

TEST(SimulateCommand, WrongUsageIsTwo) {
  EXPECT_EQ(run({}).status, 2);
  EXPECT_EQ(run({"--town"}).status, 2);
  EXPECT_EQ(run({"--town", "--live", "--log", kLog}).status, 2);
  EXPECT_EQ(run({"--bogus"}).status, 2);
  EXPECT_EQ(run({"--town", "--log", kLog, "--seconds", "-3"}).status, 2);
  EXPECT_EQ(run({"--town", "--log", kLog, "--fault", "imu-loud:1-2"}).status, 2);
  EXPECT_EQ(run({"--scans", "/tmp", "--log", kLog}).status, 2) << "no poses";
  EXPECT_EQ(run({"--town", "--log", kLog, "--set", "speeed=2"}).status, 2);
  EXPECT_EQ(run({"--town", "--log", kLog, "--loop", "50"}).status, 2);
  EXPECT_EQ(run({"--town", "--log", kLog, "--opposite"}).status, 2);
}

TEST(SimulateCommand, AFailingEnvironmentIsOneAndOneLine) {
  for (const auto& arguments : std::vector<std::vector<std::string>>{
           {"--town", "--seconds", "1", "--log", "/no/such/folder/x.lcmlog"},
           {"--town", "--seconds", "1", "--log", kLog, "--truth", "/proc/nothing/here"},
           {"--scans", "/no/such/folder", "--poses", "/no/such/file", "--log", kLog},
           {"--scans", testing::TempDir(), "--poses", "/no/such/file", "--log", kLog}}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(std::count(outcome.errors.begin(), outcome.errors.end(), '\n'), 1) << outcome.errors;
  }
}

TEST(SimulateCommand, WritesLogAndTruth) {
  const std::string truth = testing::TempDir() + "command_truth";
  EXPECT_EQ(run({"--town", "--seed", "4", "--seconds", "0.5", "--log", kLog, "--truth", truth}).status, 0);
  EXPECT_GT(std::filesystem::file_size(kLog), 100'000U);
  EXPECT_TRUE(std::filesystem::exists(truth + "/truth.json"));
}

}  // namespace
}  // namespace curbstone
