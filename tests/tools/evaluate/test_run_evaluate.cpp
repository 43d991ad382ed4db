#include <gmock/gmock.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "common/log/log_writer.hpp"
#include "services/semantic_map/store/map_store.hpp"
#include "tests/damaged_file.hpp"
#include "tests/temporary_folder.hpp"
#include "tools/evaluate/evaluate.hpp"
#include "tools/stored_picture/stored_picture.hpp"

namespace curbstone::evaluate {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// A folder with a small map along the x axis and the truth of the same drive.
class RunEvaluate : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(folder_ / "truth");
    fs::remove(folder_ / "map.db");
    fs::create_directories(folder_ / "truth");
    std::ofstream poses(folder_ / "truth/poses.csv");
    poses << "utime,x,y,z,qw,qx,qy,qz\n";
    std::ofstream curbs(folder_ / "truth/curbs.csv");
    curbs << "line,x,y,z,height,dropped\n";
    semantic_map::store::MapStore::Batch batch;
    for (int i = 0; i < 200; ++i) {
      Pose T_map_base = Pose::Identity();
      T_map_base.translation().x() = 0.1 * i;
      batch.trajectory.push_back({1'000'000 + 50'000 * i, i, T_map_base});
      poses << 1'000'000 + 50'000 * i << "," << 0.1 * i << ",0,0,1,0,0,0\n";
      if (i <= 180) curbs << "0," << 0.1 * i << ",1.5,0,0.1,0\n";
    }
    for (int x = 0; x < 6; ++x) {
      semantic_map::tile::MapTile tile;
      tile.key = {x, 0};
      tile.cell_class.fill(semantic_map::tile::CellClass::kRoad);
      for (std::size_t c = 0; c < kCellsPerTile; ++c)
        tile.cell_class[12 * kCellsPerTile + c] = semantic_map::tile::CellClass::kCurb;
      batch.tiles.push_back(tile);
    }
    semantic_map::store::MapStore store(path("map.db"));
    store.write(batch);
    store.close_canonical();
  }

  [[nodiscard]] std::string bytes_of(const char* name) const {
    std::ifstream in(folder_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  [[nodiscard]] std::string path(const char* name) const { return (folder_ / name).string(); }
  int run(std::vector<std::string> arguments = {}) const {
    std::vector<std::string> all = {"evaluate", "--map", path("map.db"), "--truth", path("truth")};
    all.insert(all.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& argument : all) argv.push_back(argument.data());
    return run_evaluate(static_cast<int>(argv.size()), argv.data());
  }
  void expect_failure(const std::string& file, const std::string& words,
                      std::vector<std::string> arguments = {}) const {
    EXPECT_THAT([&] { run(arguments); }, ThrowsMessage<std::exception>(AllOf(HasSubstr(file), HasSubstr(words),
                                                                             ::testing::Not(HasSubstr("\n")))));
  }

  test::TemporaryFolder folder_;
};

TEST_F(RunEvaluate, PrintsATableAndWritesJson) {
  ::testing::internal::CaptureStdout();
  EXPECT_EQ(run({"--json", path("report.json")}), 0);
  EXPECT_THAT(::testing::internal::GetCapturedStdout(), HasSubstr("19.9 m driven"));
  std::ifstream file(path("report.json"));
  const auto json = nlohmann::json::parse(file);
  EXPECT_EQ(json.at("curb").at("0.12").at("f1"), 1.0);
  EXPECT_NEAR(json.at("trajectory").at("distance_m").get<double>(), 19.9, 1e-9);
  EXPECT_FALSE(fs::exists(path("report.json.part")));
}

TEST_F(RunEvaluate, DrawsTheMapAndTheTruthOverIt) {
  EXPECT_EQ(run({"--picture", path("map.png"), "--overlay", path("truth.png")}), 0);
  EXPECT_GT(fs::file_size(path("map.png")), 1000U);
  EXPECT_GT(fs::file_size(path("truth.png")), fs::file_size(path("map.png")));  // there is more in it
  expect_failure("/nowhere/map.png", "", {"--picture", "/nowhere/map.png"});
}

TEST_F(RunEvaluate, DrawsThePaintOnTheRoadThatTheMapHolds) {
  EXPECT_EQ(run({"--picture", path("bare.png")}), 0);
  {
    const std::vector<semantic_map::tile::MarkingLine> markings = {{.type = semantic_map::tile::MarkingType::kSolid,
                                                                    .width = 0.3F,
                                                                    .points = {{1, 2, 0, true}, {9, 2, 0, false}}}};
    semantic_map::store::MapStore store(path("map.db"));
    semantic_map::store::MapStore::Batch batch;
    batch.markings = &markings;
    store.write(batch);
  }
  EXPECT_EQ(run({"--picture", path("painted.png")}), 0);
  const semantic_map::store::MapReader map(path("map.db"));
  const auto picture = output::stored_picture(map);
  EXPECT_EQ(picture.markings, map.markings());
  EXPECT_EQ(picture.tiles.size(), 6U);
  EXPECT_EQ(picture.path.size(), 200U);
  EXPECT_NE(bytes_of("bare.png"), bytes_of("painted.png"));
}

TEST_F(RunEvaluate, SaysWhichInputIsMissing) {
  fs::rename(path("map.db"), path("other.db"));
  expect_failure("map.db", "");
  fs::rename(path("other.db"), path("map.db"));
  expect_failure("drive.lcmlog", "", {"--log", path("drive.lcmlog")});
  expect_failure("report.json", "cannot be written", {"--json", "/nowhere/report.json"});
  fs::remove_all(path("truth"));
  expect_failure("poses.csv", "cannot be read");
}

TEST_F(RunEvaluate, RefusesAMapThatIsCutOff) {
  for (const std::uintmax_t size : {fs::file_size(path("map.db")) / 2, std::uintmax_t{4096}, std::uintmax_t{100}}) {
    SetUp();
    fs::resize_file(path("map.db"), size);
    expect_failure("map.db", "");
  }
}

TEST_F(RunEvaluate, RefusesALogThatIsNone) {
  std::ofstream(path("drive.lcmlog")) << "this is no log";
  expect_failure("drive.lcmlog", "", {"--log", path("drive.lcmlog")});
}

TEST_F(RunEvaluate, OfADamagedLogItSaysSoAndTheExitStatusTellsPrograms) {
  {
    LogWriter log(path("drive.lcmlog"));
    const std::array<std::uint8_t, 100> bytes{};
    for (int i = 0; i < 50; ++i) log.write("IMU", bytes.data(), 100);
  }
  EXPECT_EQ(run({"--log", path("drive.lcmlog")}), 0);
  test::damage_middle(path("drive.lcmlog"), 200);
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(run({"--log", path("drive.lcmlog"), "--json", path("report.json")}), 1);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("damaged at 1 place: "));
  EXPECT_TRUE(fs::exists(path("report.json"))) << "what could be read is reported";
}

TEST_F(RunEvaluate, KnowsUsage) {
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(run({"--no-such-option"}), 2);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(), HasSubstr("--no-such-option"));
}

}  // namespace
}  // namespace curbstone::evaluate
