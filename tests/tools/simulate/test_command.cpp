// The command line: what is wrong is said in one line, with the right exit status.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/temporary_folder.hpp"
#include "tools/command/run_subcommand.hpp"
#include "tools/simulate/simulate.hpp"

namespace curbstone::simulate {
namespace {

struct Outcome {
  int status;
  std::string errors;
};

Outcome run(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "simulate");
  std::vector<char*> argv;
  for (auto& argument : arguments) argv.push_back(argument.data());
  ::testing::internal::CaptureStderr();
  ::testing::internal::CaptureStdout();
  const int status = command::run_subcommand("simulate", run_simulate, static_cast<int>(argv.size()), argv.data());
  ::testing::internal::GetCapturedStdout();
  return {status, ::testing::internal::GetCapturedStderr()};
}

class SimulateCommand : public ::testing::Test {
 protected:
  test::TemporaryFolder folder_;
  std::string log_ = folder_ / "command.lcmlog";
};

TEST_F(SimulateCommand, WrongUsageIsTwo) {
  EXPECT_EQ(run({}).status, 2);
  EXPECT_EQ(run({"--town"}).status, 2);
  EXPECT_EQ(run({"--town", "--live", "--log", log_}).status, 2);
  EXPECT_EQ(run({"--bogus"}).status, 2);
  EXPECT_EQ(run({"--town", "--log", log_, "--seconds", "-3"}).status, 2);
  EXPECT_EQ(run({"--town", "--log", log_, "--fault", "imu-loud:1-2"}).status, 2);
  EXPECT_EQ(run({"--scans", folder_.path(), "--log", log_}).status, 2) << "no poses";
  EXPECT_EQ(run({"--town", "--log", log_, "--set", "speeed=2"}).status, 2);
  EXPECT_EQ(run({"--town", "--log", log_, "--loop", "50"}).status, 2);
  EXPECT_EQ(run({"--town", "--log", log_, "--opposite"}).status, 2);
  EXPECT_EQ(run({"--town", "--log", log_, "--straight", "400", "--loop", "800"}).status, 2);
}

TEST_F(SimulateCommand, AFailingEnvironmentIsOneAndOneLine) {
  for (const auto& arguments : std::vector<std::vector<std::string>>{
           {"--town", "--seconds", "1", "--log", "/no/such/folder/x.lcmlog"},
           {"--town", "--seconds", "1", "--log", log_, "--truth", "/proc/nothing/here"},
           {"--scans", "/no/such/folder", "--poses", "/no/such/file", "--log", log_},
           {"--scans", folder_.path(), "--poses", "/no/such/file", "--log", log_}}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(std::count(outcome.errors.begin(), outcome.errors.end(), '\n'), 1) << outcome.errors;
  }
}

TEST_F(SimulateCommand, WritesLogAndTruth) {
  const std::string truth = folder_ / "truth";
  EXPECT_EQ(run({"--town", "--seed", "4", "--seconds", "0.5", "--log", log_, "--truth", truth}).status, 0);
  EXPECT_GT(std::filesystem::file_size(log_), 100'000U);
  EXPECT_TRUE(std::filesystem::exists(truth + "/truth.json"));
}

}  // namespace
}  // namespace curbstone::simulate
