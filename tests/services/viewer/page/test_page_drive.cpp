#include <fmt/format.h>

#include <cstdlib>
#include <random>

#include "common/log/log_files.hpp"
#include "common/log/log_reader.hpp"
#include "services/semantic_map/store/map_store.hpp"
#include "tests/paths.hpp"
#include "tests/services/viewer/page/page_on_a_bus.hpp"
#include "tools/replay/vehicle.hpp"

namespace curbstone::viewer {
namespace {

using semantic_map::store::MapReader;

/// A vehicle that makes its map from a log, and between it and the viewer a wire that loses messages both ways.
class PageOfADrive : public PageOnABus {
 protected:
  static constexpr double kLoss = 0.1;
  static constexpr std::int64_t kRound = 20'000;  // us of message time

  void SetUp() override {
    PageOnABus::SetUp();
    if (IsSkipped()) return;
    bus_is_alive = false;  // the mapper says the poses
    browser->resize(640, 520);
    const std::string command = fmt::format("{} simulate --town --seconds 8.5 --set standstill=1 --log {} > {} 2>&1",
                                            test::program_path("curbstone"), (folder_ / "drive.lcmlog").string(),
                                            (folder_ / "simulate.txt").string());
    ASSERT_EQ(std::system(command.c_str()), 0);
    vehicle_bus_.tap([this](const std::string& channel, const void* data, int size, std::int64_t) {
      if (channel != "TILE_REQUEST" && !is_lost()) inject(channel, data, size);
    });
    replay::ReplayOptions options;
    options.assignments = {"mapper.folder="};
    options.map_file = folder_ / "map.db";
    options.tick_period = kRound;
    vehicle_.emplace(options, vehicle_bus_);
  }
  void start_viewer_beside_it(int port = 0) {
    start_viewer(port);
    bus().tap([this](const std::string& channel, const void* data, int size, std::int64_t) {
      if (channel == "TILE_REQUEST" && !is_lost()) vehicle_bus_.inject(channel, data, size);
    });
  }
  /// Until so many seconds after the log's first record, or its end. The browser looks on.
  void drive(LogFiles& log, double until) {
    while (const auto event = log.next()) {
      if (begin_ == 0) begin_ = event->log_utime;
      if (static_cast<double>(event->log_utime - begin_) * 1e-6 > until) return;
      if (event->channel != "LIDAR_POINTS" && event->channel != "IMU" && event->channel != "WHEELS") continue;
      if (event->log_utime - now_ >= kRound) {
        now_ = event->log_utime;
        vehicle_->advance(now_);
        browser->pass(0.001);
      }
      vehicle_bus_.inject(event->channel, event->bytes.data(), static_cast<int>(event->bytes.size()));
      vehicle_bus_.dispatch();
    }
  }
  /// The vehicle stands; its services go on telling what there is to whoever misses some of it.
  bool stand_until(const std::function<bool()>& done) {
    for (int round = 0; round < 3000; ++round) {
      vehicle_->advance(now_ += kRound);
      vehicle_bus_.dispatch();
      browser->pass(0.01);
      if (round % 50 == 49 && done()) return true;
    }
    return false;
  }
  /// How many tiles of the file the page has otherwise, or not at all. All are asked for at once: the browser answers a
  /// hundred questions later than one.
  int other_tiles(const MapReader& file) {
    const auto shown = browser->evaluate(
        "Object.fromEntries([...curbstone.world.tiles].map(([key, t]) => "
        "[key, [[...t.classes], [...t.heights], [...t.costs]].map(values => values.join(' '))]))");
    const auto words_of = [](const auto& values) {
      std::string words;
      for (const auto value : values) words += (words.empty() ? "" : " ") + std::to_string(static_cast<int>(value));
      return words;
    };
    int other = 0;
    for (const auto& tile : file.tiles()) {
      const std::string key = fmt::format("{},{}", tile.key.x, tile.key.y);
      const bool same = shown.contains(key) && shown[key][0] == words_of(tile.cell_class) &&
                        shown[key][1] == words_of(tile.height) && shown[key][2] == words_of(tile.cost);
      other += same ? 0 : 1;
    }
    return other;
  }

  curbstone::test::TemporaryFolder folder_;
  LocalBus vehicle_bus_;
  std::optional<replay::ReplayVehicle> vehicle_;
  std::int64_t begin_ = 0;  // us of message time
  std::int64_t now_ = 0;
  std::int64_t lost_ = 0;

 private:
  bool is_lost() {
    const bool lost = std::uniform_real_distribution<>(0, 1)(random_) < kLoss;
    lost_ += lost ? 1 : 0;
    return lost;
  }
  std::mt19937 random_{3};
};

TEST_F(PageOfADrive, ShowsWhatTheMapFileHasThoughATenthWasLostAndTheViewerKilled) {
  stop_viewer();
  start_viewer_beside_it(config.port);
  browser->open(address + "#theme=light");
  LogFiles log({folder_ / "drive.lcmlog"});
  drive(log, 5.5);
  ASSERT_TRUE(browser->comes_to("curbstone.world.tiles.size > 50"))
      << browser->evaluate("[curbstone.world.tiles.size, document.body.innerText]");
  stop_viewer();
  drive(log, 6.5);
  start_viewer_beside_it(config.port);
  drive(log, 1e9);
  EXPECT_GT(lost_, 500);

  vehicle_->finish();
  const MapReader file(folder_ / "map.db");
  EXPECT_GT(file.tiles().size(), 100U);
  EXPECT_TRUE(stand_until([&] { return other_tiles(file) == 0; })) << other_tiles(file);
  if (HasFailure()) browser->save_picture(::testing::TempDir() + "page_of_a_drive.png");
}

}  // namespace
}  // namespace curbstone::viewer
