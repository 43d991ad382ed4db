// What holds for the command line of every program.
#include <gmock/gmock.h>

#include <algorithm>

#include "tests/system/run_program.hpp"

namespace curbstone::system_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;

class EveryCommand : public ::testing::TestWithParam<const char*> {};

TEST_P(EveryCommand, SaysItsVersionAndItsOptions) {
  const std::string command = GetParam();
  const auto version = run_program(command + " --version");
  EXPECT_EQ(version.exit_status, 0) << version.err;
  EXPECT_THAT(version.out, MatchesRegex("[0-9]+\\.[0-9]+\\.[0-9]+\\+.+\n"));
  const auto help = run_program(command + " --help");
  EXPECT_EQ(help.exit_status, 0) << help.err;
  EXPECT_THAT(help.out, ::testing::ContainsRegex("[Uu]sage"));
  EXPECT_EQ(help.err, "");
}

TEST_P(EveryCommand, DoesNotEndWellWhenWhatItPrintsIsLost) {
  for (const char* option : {" --version", " --help"}) {
    const auto into = [&](const char* where) {
      return run_program("sh -c '" + std::string(GetParam()) + option + " " + where + "'");
    };
    const auto lost = into(">/dev/full");
    EXPECT_EQ(lost.exit_status, 1);
    EXPECT_THAT(lost.err, MatchesRegex("standard output: cannot be written: [^\n]+\n"));
    EXPECT_EQ(into(">&-").exit_status, 0) << "nobody wants to know";
  }
}

INSTANTIATE_TEST_SUITE_P(All, EveryCommand,
                         ::testing::Values("curbstone", "curbstone simulate", "curbstone replay", "curbstone evaluate",
                                           "curbstone lidar", "curbstone-log", "curbstone log info", "curbstone-play",
                                           "curbstone-view", "curbstone-spy", "curbstone-doctor", "curbstone-sheriff",
                                           "curbstone-deputy", "curbstone-lidar", "curbstone-imu", "curbstone-encoder",
                                           "curbstone-ekf", "curbstone-mapper", "curbstone-tensor-voting",
                                           "curbstone-semantic-map", "curbstone-localizer", "curbstone-recorder",
                                           "curbstone-viewer", "curbstone-relay"));

/// LCM would abort at some of them.
TEST(EveryBus, ThatIsNoneIsOneClearError) {
  for (const char* command : {"curbstone-sheriff status", "curbstone-deputy --allow-any", "curbstone-spy --once",
                              "curbstone-spy", "curbstone-play /dev/null", "curbstone-ekf", "curbstone-relay"}) {
    for (const char* url : {"tcpq://127.0.0.1:1", "nonsense", "udpm://1.2.3.4:7667"}) {
      for (const std::string& given :
           {command + std::string(" --lcm-url ") + url, "env LCM_DEFAULT_URL=" + std::string(url) + " " + command}) {
        const auto result = run_program(given);
        EXPECT_EQ(result.exit_status, 1) << given << result.err;
        EXPECT_THAT(result.err, AllOf(HasSubstr("cannot open the bus"), HasSubstr(url))) << given;
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
      }
    }
  }
}

}  // namespace
}  // namespace curbstone::system_test
