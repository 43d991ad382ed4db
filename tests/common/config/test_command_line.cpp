#include "common/config/command_line.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <limits>

#include "common/config/version.hpp"

namespace curbstone {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Optional;

/// What a program would print and how it would end.
struct Reading {
  std::optional<int> status;
  std::string out;
  std::string err;
};

Reading read_words(CommandLine& line, std::vector<const char*> words) {
  words.insert(words.begin(), "program");
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  Reading reading;
  reading.status = line.read(static_cast<int>(words.size()), words.data());
  reading.out = ::testing::internal::GetCapturedStdout();
  reading.err = ::testing::internal::GetCapturedStderr();
  return reading;
}

enum class ColourChoice { kRed, kGreen };

/// A command line with one option of each kind.
struct CommandLineTest : ::testing::Test {
  CommandLineTest() {
    line.argument("log", log, "a log").required();
    line.option("-n,--name", name, "a name").shows_default();
    line.option("--seconds", seconds, "a length").within(0.5, 10.0);
    line.option("--port", port, "a port").within(1, 65535);
    line.option("--utime", utime, "a time");
    line.option("--seed", seed, "a seed");
    line.option("--range", range, "a range").not_negative();
    line.option("--parts", parts, "some parts").comma_separated().one_of({"scans", "drives"});
    line.option("--sizes", sizes, "some sizes").comma_separated().within(1, 100);
    line.option("--decays", decays, "some decays").comma_separated();
    line.heading("More");
    const auto set_option = line.option("--set", set, "assignments").one_each();
    line.option("--folder", folder, "a folder").existing_folder();
    line.flag("--quiet", quiet, "says less").excludes(set_option);
    line.choice("--colour", colour, {{"red", ColourChoice::kRed}, {"green", ColourChoice::kGreen}}, "a colour");
  }

  std::string log, name = "ekf", folder;
  double seconds = 1;
  double range = 1;
  int port = 80;
  std::int64_t utime = 0;
  std::uint64_t seed = 0;
  std::vector<std::string> parts = {"scans"}, set;
  std::vector<std::uint64_t> sizes;
  std::vector<double> decays;
  bool quiet = false;
  ColourChoice colour = ColourChoice::kGreen;
  CommandLine line{"Does something", "curbstone test"};
};

TEST_F(CommandLineTest, WhatIsNotGivenStaysAsItWas) {
  EXPECT_EQ(read_words(line, {"a.log"}).status, std::nullopt);
  EXPECT_EQ(log, "a.log");
  EXPECT_EQ(name, "ekf");
  EXPECT_EQ(port, 80);
  EXPECT_THAT(parts, ElementsAre("scans"));
  EXPECT_FALSE(quiet);
  EXPECT_EQ(colour, ColourChoice::kGreen);
  EXPECT_FALSE(line.given("--port"));
}

TEST_F(CommandLineTest, ValuesOfEveryKindAreRead) {
  const Reading reading =
      read_words(line, {"-n", "imu", "--seconds=2.5", "--port", "7", "--utime", "-9223372036854775808", "--seed",
                        "18446744073709551615", "--range", "0", "--decays", "0.1,1e-3", "--colour", "red", "a.log"});
  EXPECT_EQ(reading.status, std::nullopt) << reading.err;
  EXPECT_EQ(name, "imu");
  EXPECT_EQ(seconds, 2.5);
  EXPECT_EQ(port, 7);
  EXPECT_EQ(utime, std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(seed, std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(range, 0);
  EXPECT_THAT(decays, ElementsAre(0.1, 1e-3));
  EXPECT_EQ(colour, ColourChoice::kRed);
  EXPECT_TRUE(line.given("--port"));
  EXPECT_TRUE(line.given("--name"));
}

TEST_F(CommandLineTest, ACommaSeparatedListReplacesItsDefault) {
  EXPECT_EQ(read_words(line, {"a.log", "--parts", "drives,scans", "--sizes", "1,2,3"}).status, std::nullopt);
  EXPECT_THAT(parts, ElementsAre("drives", "scans"));
  EXPECT_THAT(sizes, ElementsAre(1, 2, 3));
}

TEST_F(CommandLineTest, AListOfOneEachLeavesWhatStandsBehindAlone) {
  EXPECT_EQ(read_words(line, {"--set", "a=1", "--set", "b=2", "a.log"}).status, std::nullopt);
  EXPECT_THAT(set, ElementsAre("a=1", "b=2"));
  EXPECT_EQ(log, "a.log");
}

TEST_F(CommandLineTest, HelpAndVersionArePrintedAndEndTheProgramWell) {
  const Reading help = read_words(line, {"--help"});
  EXPECT_THAT(help.status, Optional(0));
  EXPECT_THAT(help.out, HasSubstr("Does something"));
  EXPECT_THAT(help.out, HasSubstr("curbstone test [OPTIONS] log"));
  EXPECT_THAT(help.out, HasSubstr("-n,--name TEXT=ekf"));
  EXPECT_THAT(help.out, HasSubstr("FLOAT in [0.5 - 10]"));
  EXPECT_THAT(help.out, HasSubstr("INT in [1 - 65535]"));
  EXPECT_THAT(help.out, HasSubstr("{red,green}"));
  EXPECT_THAT(help.out, HasSubstr("\nMore:\n"));
  EXPECT_THAT(help.err, IsEmpty());
  const Reading version = read_words(line, {"--version"});
  EXPECT_THAT(version.status, Optional(0));
  EXPECT_EQ(version.out, curbstone::version() + "\n");
}

TEST_F(CommandLineTest, WhatIsWrongIsNamedAndEndsTheProgramWithTwo) {
  struct Wrong {
    std::vector<const char*> words;
    const char* named;
  };
  const std::vector<Wrong> wrong = {
      {{}, "log is required"},
      {{"a.log", "b.log"}, "b.log"},
      {{"a.log", "--nothing"}, "--nothing"},
      {{"a.log", "--name"}, "--name"},
      {{"a.log", "--seconds", "0.4"}, "0.5"},
      {{"a.log", "--seconds", "fast"}, "--seconds"},
      {{"a.log", "--seconds", "nan"}, "nan is no number"},
      {{"a.log", "--decays", "0.1,-inf"}, "-inf is no number"},
      {{"a.log", "--port", "65536"}, "65535"},
      {{"a.log", "--port", "1.5"}, "--port"},
      {{"a.log", "--seed", "-1"}, "--seed"},
      {{"a.log", "--seed", "18446744073709551616"}, "--seed"},
      {{"a.log", "--utime", "9223372036854775808"}, "--utime"},
      {{"a.log", "--sizes", "1,-1"}, "-1"},
      {{"a.log", "--range", "-1"}, "--range"},
      {{"a.log", "--parts", "scans,walls"}, "walls"},
      {{"a.log", "--sizes", "5,101"}, "101"},
      {{"a.log", "--folder", "/no/such/folder"}, "/no/such/folder"},
      {{"a.log", "--colour", "blue"}, "blue"},
      {{"a.log", "--set", "a=1", "--quiet"}, "excludes"},
  };
  for (const auto& [words, named] : wrong) {
    const Reading reading = read_words(line, words);
    EXPECT_THAT(reading.status, Optional(2)) << named;
    EXPECT_THAT(reading.err, HasSubstr(named));
    EXPECT_THAT(reading.err, HasSubstr("Run with --help for more information."));
    EXPECT_THAT(reading.out, IsEmpty());
  }
}

TEST_F(CommandLineTest, WhatTheProgramItselfRefusesReadsTheSame) {
  ASSERT_EQ(read_words(line, {"a.log"}).status, std::nullopt);
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(line.refuse("--seed and --utime belong together"), 2);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(),
            "--seed and --utime belong together\nRun with --help for more information.\n");
}

TEST(CommandLine, IsCalledAsTheProgramWasUnlessItIsNamed) {
  CommandLine line("Does something");
  const Reading help = read_words(line, {"-h"});
  EXPECT_THAT(help.out, HasSubstr("Usage: program [OPTIONS]"));
}

/// `nohup program >&-`: what is printed must not go into the next file that is opened.
TEST(CommandLine, NoFileTakesTheNumberOfAClosedStream) {
  std::fflush(stdout);
  const int saved = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 10);
  close(STDOUT_FILENO);
  const char* word = "program";
  CommandLine line("Does something");
  const auto status = line.read(1, &word);
  const int file = open("/proc/self/status", O_RDONLY | O_CLOEXEC);
  dup2(saved, STDOUT_FILENO);
  close(saved);
  EXPECT_EQ(status, std::nullopt);
  EXPECT_GT(file, STDERR_FILENO);
  close(file);
}

}  // namespace
}  // namespace curbstone
