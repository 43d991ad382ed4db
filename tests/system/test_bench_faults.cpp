#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/paths.hpp"
#include "tests/system/run_program.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::system_test {
namespace {

TEST(BenchFaults, MeasuresADriveInWhichAProcessIsKilled) {
  const test::TemporaryFolder folder;
  const std::string json = folder / "figures.json";
  const auto run =
      run_program("curbstone-bench faults --only 'kill -9 semantic_map' --seconds 12 --json " + json + " --procman " +
                      test::source_path("procman/demo.cfg") + " --config " + test::source_path("config/ugv.yaml"),
                  250);
  ASSERT_EQ(run.exit_status, 0) << run.err;
  const auto figures = nlohmann::json::parse(std::ifstream(json));
  ASSERT_EQ(figures["rows"].size(), 1U);
  const auto& row = figures["rows"][0];
  EXPECT_EQ(row["map"], "ok");
  const auto& undisturbed = figures["undisturbed"].back();
  EXPECT_EQ(row["cells_differ"].is_null(), undisturbed["spoiled"].get<bool>());
  if (undisturbed["spoiled"]) GTEST_SKIP() << "the machine is too busy: " << undisturbed;
  EXPECT_GT(undisturbed["poses"], 200);
  EXPECT_GT(undisturbed["cells"], 20000);
  EXPECT_LT(row["cells_differ"], undisturbed["cells"].get<int>() / 4) << "what was mapped before is there";
}

TEST(BenchFaults, KeepsOffABusOnWhichADeputyIs) {
  const test::TemporaryFolder folder;
  write_file(folder / "test.cfg", "cmd \"a\" { exec = \"sleep 1000\"; deputy = \"d\"; }");
  BackgroundProgram deputy("curbstone-deputy --config " + (folder / "test.cfg").string(), folder / "output");
  const auto run = run_program("curbstone-bench faults --procman " + test::source_path("procman/demo.cfg") +
                                   " --config " + test::source_path("config/ugv.yaml"),
                               60);
  EXPECT_EQ(run.exit_status, 1);
  EXPECT_THAT(run.err, ::testing::HasSubstr("a deputy is on this bus already"));
}

}  // namespace
}  // namespace curbstone::system_test
