#include <gmock/gmock.h>
#include <sys/resource.h>
#include <unistd.h>

#include "tests/paths.hpp"
#include "tests/system/run_program.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::system_test {
namespace {

using ::testing::HasSubstr;

const std::string kVehicle = test::source_path("config/ugv.yaml");

class EveryProgram : public ::testing::TestWithParam<const char*> {};

TEST_P(EveryProgram, LoadsTheVehiclesFileAndDumpsWhatItMakesOfIt) {
  const test::TemporaryFolder folder;
  const auto result = run_program(std::string("curbstone-") + GetParam() + " --config " + kVehicle + " --dump-config");
  EXPECT_EQ(result.exit_status, 0) << result.err;
  EXPECT_EQ(result.err, "");
  write_file(folder / "dump.yaml", result.out);
  const auto again = run_program(std::string("curbstone-") + GetParam() + " --config " +
                                 (folder / "dump.yaml").string() + " --dump-config");
  EXPECT_EQ(again.exit_status, 0) << again.err;
  EXPECT_EQ(again.out, result.out) << "a dump is a config that gives the same";
}

TEST_P(EveryProgram, NeedsNoFileAtAll) {
  EXPECT_EQ(run_program(std::string("curbstone-") + GetParam() + " --dump-config").exit_status, 0);
}

TEST_P(EveryProgram, NamesFileLineAndTheNearestKeyForAnUnknownOne) {
  const test::TemporaryFolder folder;
  std::string section = GetParam();
  std::replace(section.begin(), section.end(), '-', '_');
  write_file(folder / "bad.yaml", "# a comment\n" + section + ":\n  no_such_key: 1\n");
  const auto result =
      run_program(std::string("curbstone-") + GetParam() + " --config " + (folder / "bad.yaml").string());
  EXPECT_EQ(result.exit_status, 2);
  EXPECT_THAT(result.err, HasSubstr("bad.yaml:3"));
  EXPECT_THAT(result.err, HasSubstr("no_such_key"));
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
}

TEST(Services, YieldToOthersWhenToldTo) {
  const test::TemporaryFolder folder;
  BackgroundProgram program("curbstone-ekf --nice 7", folder / "output");
  for (int i = 0; i < 500 && getpriority(PRIO_PROCESS, static_cast<id_t>(program.pid())) != 7; ++i) usleep(10'000);
  EXPECT_EQ(getpriority(PRIO_PROCESS, static_cast<id_t>(program.pid())), 7) << program.output();
  EXPECT_EQ(run_program("curbstone-ekf --nice -1").exit_status, 2) << "before others it must not push itself";
}

TEST_P(EveryProgram, RefusesAMissingFileABadOptionAndABadBus) {
  const std::string program = std::string("curbstone-") + GetParam();
  const auto missing = run_program(program + " --config /nowhere/ugv.yaml");
  EXPECT_EQ(missing.exit_status, 2);
  EXPECT_THAT(missing.err, HasSubstr("/nowhere/ugv.yaml"));
  EXPECT_EQ(std::count(missing.err.begin(), missing.err.end(), '\n'), 1) << missing.err;
  EXPECT_EQ(run_program(program + " --no-such-option").exit_status, 2);
  const auto bus = run_program(program + " --lcm-url nonsense://x");
  EXPECT_EQ(bus.exit_status, 1);
  EXPECT_THAT(bus.err, HasSubstr("nonsense://x"));
}

INSTANTIATE_TEST_SUITE_P(All, EveryProgram,
                         ::testing::Values("lidar", "imu", "encoder", "ekf", "mapper", "tensor-voting", "semantic-map",
                                           "localizer", "recorder", "viewer", "relay"));

}  // namespace
}  // namespace curbstone::system_test
