// The command line: what is wrong is said in one line, with the right exit status.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
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
  EXPECT_EQ(run({"--loop", "800", "--scans", folder_.path(), "--poses", "x", "--log", log_}).status, 2);
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

/// `--log drive.lcmlog` replaced a recorded drive, or anything else, without a word.
TEST_F(SimulateCommand, ReplacesOnlyWhatItCanMakeAgain) {
  const std::vector<std::string> made = {"--town", "--seconds", "0.2", "--log", log_};
  const auto with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all = made;
    all.insert(all.end(), more.begin(), more.end());
    return run(all);
  };
  std::ofstream(log_) << "something else";
  EXPECT_EQ(run(made).status, 1);
  EXPECT_EQ(std::filesystem::file_size(log_), 14U);
  EXPECT_EQ(with({"--force"}).status, 0);
  std::filesystem::resize_file(log_, 0);
  EXPECT_EQ(run(made).status, 0) << "nothing";
  EXPECT_EQ(run(made).status, 0) << "an emulated drive";
  const Outcome recorded = with({"--start-utime", "1760000000000000"});
  EXPECT_EQ(recorded.status, 1) << "as if the one that is there were a recorded drive";
  EXPECT_NE(recorded.errors.find("--force"), std::string::npos) << recorded.errors;
  EXPECT_FALSE(std::filesystem::exists(log_ + ".part"));
}

}  // namespace
}  // namespace curbstone::simulate
