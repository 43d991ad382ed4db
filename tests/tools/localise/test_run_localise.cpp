#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <curbstone/service_config_t.hpp>
#include <fstream>
#include <string>
#include <vector>

#include "common/log/log_reader.hpp"
#include "common/log/log_writer.hpp"
#include "services/semantic_map/store/map_store.hpp"
#include "tests/temporary_folder.hpp"
#include "tools/command/run_subcommand.hpp"
#include "tools/localise/localise.hpp"
#include "tools/simulate/simulate.hpp"

namespace curbstone::localise {
namespace {

using ::testing::HasSubstr;

/// The begin of a town's drive, and a map of one tile, on which it is lost.
class RunLocalise : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(run(simulate::run_simulate, {"simulate", "--town", "--seconds", "3", "--log", bare_}), 0);
    semantic_map::tile::MapTile tile;
    tile.cell_class.fill(semantic_map::tile::CellClass::kRoad);
    tile.height.fill(0);
    semantic_map::store::MapStore store(map_);
    store.write({.epoch = 1, .tiles = {tile}});
    store.close_canonical();
  }
  int run(command::Run subcommand, std::vector<std::string> words) {
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const int status = command::run_subcommand(words[0], subcommand, static_cast<int>(argv.size()), argv.data());
    out_ = testing::internal::GetCapturedStdout();
    err_ = testing::internal::GetCapturedStderr();
    return status;
  }
  int localise(const std::string& log, const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {"localise", map_, "--log", log};
    words.insert(words.end(), more.begin(), more.end());
    return run(run_localise, words);
  }
  /// The drive, recorded with this configuration of the ekf.
  [[nodiscard]] std::string recorded_with(const std::string& yaml) const {
    LogReader bare(bare_);
    const std::string file = folder_ / "recorded.lcmlog";
    LogWriter log(file);
    const service_config_t config{1, "ekf", "ekf", "ugv", "0.0.1", yaml};
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(config.getEncodedSize()));
    config.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    bool is_first = true;
    while (const auto event = bare.next()) {
      if (event->channel == "CONFIG") continue;
      if (is_first) log.write("CONFIG", bytes.data(), static_cast<int>(bytes.size()), event->log_utime);
      is_first = false;
      log.write(event->channel, event->bytes.data(), static_cast<int>(event->bytes.size()), event->log_utime);
    }
    return file;
  }

  test::TemporaryFolder folder_;
  std::string bare_ = folder_ / "bare.lcmlog";
  std::string map_ = folder_ / "map.db";
  std::string out_, err_;
};

TEST_F(RunLocalise, TakesTheVehicleThatTheLogRecorded) {
  EXPECT_EQ(localise(bare_), 0) << err_;
  EXPECT_THAT(out_, HasSubstr("configuration: the defaults, as none is recorded"));
  EXPECT_EQ(localise(recorded_with("ekf:\n  vehicle:\n    lidar: [0, 0, 0.9, 0, 0, 0]\n")), 0) << err_;
  EXPECT_THAT(out_, HasSubstr("configuration: as recorded by 0.0.1; localizer: the recorded vehicle, else"));
  EXPECT_EQ(localise(recorded_with("ekf:\n  vehicle:\n    lidar: [0, 0, ninety, 0, 0, 0]\n")), 2) << out_;
  EXPECT_THAT(err_, HasSubstr("--config FILE goes without it"));
}

TEST_F(RunLocalise, TakesTheFileThatIsGivenInstead) {
  const std::string file = folder_ / "ugv.yaml";
  std::ofstream(file) << "vehicle:\n  lidar: [0, 0, 1.2, 0, 0, 0]\n";
  EXPECT_EQ(localise(recorded_with("ekf:\n  no_such_key: 1\n"), {"--config", file}), 0) << err_;
  EXPECT_THAT(out_, HasSubstr("configuration: " + file));
}

}  // namespace
}  // namespace curbstone::localise
