// curbstone SUBCOMMAND: what is linked in is called, what is a program of its own is found beside and nowhere else.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "tools/command/dispatch.hpp"

namespace curbstone::command {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr std::array kSubcommands = {
    Subcommand{"count", "how many arguments", [](int argc, char**) { return argc; }},
    Subcommand{"fail", "cannot", [](int, char**) -> int { throw std::runtime_error("the disk is full"); }},
    Subcommand{"tell", "a program of its own"},
};

class Dispatch : public ::testing::Test {
 protected:
  Dispatch() { fs::create_directories(folder_); }
  ~Dispatch() override { fs::remove_all(folder_); }

  int run(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "curbstone");
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    return dispatch(kSubcommands, folder_, static_cast<int>(arguments.size()), argv.data());
  }
  /// A program curbstone-tell that prints its arguments to stderr and ends with status 3.
  static void write_program(const fs::path& folder) {
    const fs::path program = folder / "curbstone-tell";
    std::ofstream(program) << "#!/bin/sh\necho told: \"$@\" >&2\nexit 3\n";
    fs::permissions(program, fs::perms::owner_all);
  }

  fs::path folder_ = fs::path(::testing::TempDir()) / ("dispatch_" + std::to_string(getpid()));
};

TEST_F(Dispatch, CallsWhatIsLinkedIn) {
  EXPECT_EQ(run({"count", "a", "b"}), 3) << "its name and two arguments";
}

TEST_F(Dispatch, ReportsAnException) {
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(run({"fail"}), 1);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "curbstone fail: the disk is full\n");
}

TEST_F(Dispatch, HelpListsAll) {
  ::testing::internal::CaptureStdout();
  EXPECT_EQ(run({"--help"}), 0);
  EXPECT_THAT(::testing::internal::GetCapturedStdout(),
              AllOf(HasSubstr("how many arguments"), HasSubstr("  tell       a program of its own\n")));
}

TEST_F(Dispatch, AnUnknownNameIsWrongUsage) {
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(run({"tel"}), 2);
  EXPECT_EQ(run({}), 2);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(),
              AllOf(HasSubstr("no subcommand 'tel'"), HasSubstr("usage: curbstone")));
}

TEST_F(Dispatch, BecomesTheProgramBesideAndPassesItsStatusOn) {
  write_program(folder_);
  EXPECT_EXIT(std::exit(run({"tell", "--all", "two words"})), ::testing::ExitedWithCode(3), "told: --all two words");
}

TEST_F(Dispatch, AMissingProgramIsAnErrorThatNamesTheTarget) {
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(run({"tell"}), 1);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "curbstone tell: " + (folder_ / "curbstone-tell").native() +
                                                          " is not there: scripts/build release curbstone-tell\n");
}

TEST_F(Dispatch, DoesNotSearchThePath) {
  const fs::path elsewhere = folder_ / "elsewhere";
  fs::create_directories(elsewhere);
  write_program(elsewhere);
  const std::string path = std::getenv("PATH");
  setenv("PATH", (elsewhere.native() + ":" + path).c_str(), 1);
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(run({"tell"}), 1);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("is not there"));
  setenv("PATH", path.c_str(), 1);
}

TEST_F(Dispatch, WhatCannotBeRunIsAnError) {
  fs::create_directories(folder_ / "curbstone-tell");
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(run({"tell"}), 1);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("cannot be run: Permission denied"));
}

}  // namespace
}  // namespace curbstone::command
