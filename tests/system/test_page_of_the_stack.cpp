// The page in Chromium beside the real processes, of which the viewer and semantic_map are killed.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>
#include <vector>

#include "services/semantic_map/store/map_store.hpp"
#include "tests/system/demo_drive.hpp"
#include "tools/browser/browser.hpp"

namespace curbstone::system_test {
namespace {

using browser::Browser;
using semantic_map::store::MapReader;
using semantic_map::tile::MapTile;

constexpr int kPort = 8088;
constexpr double kPagePatience = 120;  // s
constexpr double kReach = 15;          // m about the vehicle: the lines of CURBS
constexpr int kToldOf = 12;            // wrong cells, in words
constexpr double kSameCurb = 0.1;      // m between a curb of the file and one of the page

class PageOfTheStack : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!Browser::is_installed()) GTEST_SKIP() << "no chromium-headless-shell: scripts/install-deps --long";
    drive.emplace("--town --seed 1 --seconds 60", "", DemoDevices{.viewer_port = kPort});
    page.emplace([this] { drive->bus.bus.handle(std::chrono::milliseconds(1)); }, 900, 700);
  }
  /// The emulator stands still, or goes on.
  void send_to_emulator(int signal) {
    const int pid = drive->bus.pid("simulate");
    ASSERT_GT(pid, 0);
    ASSERT_EQ(kill(pid, signal), 0);
  }
  void TearDown() override {
    if (drive && drive->bus.pid("simulate") > 0) kill(drive->bus.pid("simulate"), SIGCONT);
  }
  /// How many of the file's tiles the page has otherwise, or not at all, or has and the file has not.
  int other_tiles() {
    const auto shown = page->evaluate(
        "Object.fromEntries([...curbstone.world.tiles].filter(([, t]) => t.classes.some(c => c > 0)).map(([key, t]) => "
        "[key, [t.classes, t.heights, t.costs, t.confidences].map(values => [...values].join(' '))]))");
    const auto words_of = [](const auto& values) {
      std::string words;
      for (const auto value : values) words += (words.empty() ? "" : " ") + std::to_string(static_cast<int>(value));
      return words;
    };
    int other = 0, known = 0;
    for (const MapTile& tile : MapReader(drive->map_file()).tiles()) {
      if (std::all_of(tile.cell_class.begin(), tile.cell_class.end(), [](auto c) { return static_cast<int>(c) == 0; }))
        continue;
      ++known;
      const auto at = shown.find(fmt::format("{},{}", tile.key.x, tile.key.y));
      const bool same = at != shown.end() && (*at)[0] == words_of(tile.cell_class) &&
                        (*at)[1] == words_of(tile.height) && (*at)[2] == words_of(tile.cost) &&
                        (*at)[3] == words_of(tile.confidence);
      other += same ? 0 : 1;
    }
    return other + std::max(0, static_cast<int>(shown.size()) - known);
  }
  /// And stays it: a busy machine still works on the last points, and page and file may agree in between.
  bool becomes_the_file() {
    constexpr int kTimes = 3;
    int times = 0;
    const auto begin = std::chrono::steady_clock::now();
    while (std::chrono::steady_clock::now() - begin < std::chrono::duration<double>(kPagePatience)) {
      times = other_tiles() == 0 ? times + 1 : 0;
      if (times == kTimes) return true;
      page->pass(1);
    }
    return false;
  }
  /// The share of the file's curb points near the vehicle that lie on a curb of the page.
  double curbs_on_the_page() {
    const auto lines = page->evaluate(
        "[...curbstone.world.curbs.values()].map(({ n, values }) => [[...values.slice(0, n)], [...values.slice(n, 2 * "
        "n)]])");
    const auto is_on_one = [&](double x, double y) {
      for (const auto& line : lines)
        for (std::size_t i = 0; i + 1 < line[0].size(); ++i) {
          const double ax = line[0][i], ay = line[1][i], dx = line[0][i + 1].get<double>() - ax,
                       dy = line[1][i + 1].get<double>() - ay;
          const double along =
              std::clamp(((x - ax) * dx + (y - ay) * dy) / std::max(1e-9, dx * dx + dy * dy), 0.0, 1.0);
          if (std::hypot(ax + along * dx - x, ay + along * dy - y) < kSameCurb) return true;
        }
      return false;
    };
    int near = 0, there = 0;
    for (const auto& line : MapReader(drive->map_file()).curbs())
      for (const auto& vertex : line.points) {
        const double x = vertex.x, y = vertex.y;
        if (std::hypot(x - drive->pose.map_base_position[0], y - drive->pose.map_base_position[1]) > kReach) continue;
        ++near;
        there += is_on_one(x, y) ? 1 : 0;
      }
    EXPECT_GT(near, 20);
    return near == 0 ? 0 : static_cast<double>(there) / near;
  }
  /// Of the cells in view: how many have another colour than that of their class in the file, grey as what is stale
  /// is (page/drawing/shaders.ts, palette.ts). Without those under the vehicle.
  std::pair<int, int> wrong_and_seen_cells() {
    static constexpr std::array<std::array<double, 3>, 5> kColours = {
        {{243, 244, 241}, {190, 196, 203}, {233, 133, 8}, {126, 186, 232}, {28, 88, 160}}};
    page->evaluate(R"(
        const hide = new CSSStyleSheet();
        hide.replaceSync("body > :not(#map) { visibility: hidden !important; }");
        document.adoptedStyleSheets = [hide];)");  // their shadows too
    const auto picture = page->picture();
    const auto map = page->evaluate("[[0, 0], [1, 0], [0, 1]].map(place => curbstone.camera.toScreen(...place))");
    const auto at = [&](std::size_t i, std::size_t k) { return map[i][k].get<double>(); };
    int wrong = 0, seen = 0;
    for (const MapTile& tile : MapReader(drive->map_file()).tiles())
      for (int i = 0; i < 625; ++i) {
        const auto kind = static_cast<std::size_t>(tile.cell_class[static_cast<std::size_t>(i)]);
        const double x = 3 * tile.key.x + (i % 25 + 0.5) * 0.12, y = 3 * tile.key.y + (i / 25 + 0.5) * 0.12;
        const double sx = at(0, 0) + x * (at(1, 0) - at(0, 0)) + y * (at(2, 0) - at(0, 0));
        const double sy = at(0, 1) + x * (at(1, 1) - at(0, 1)) + y * (at(2, 1) - at(0, 1));
        const double apart = std::hypot(x - drive->pose.map_base_position[0], y - drive->pose.map_base_position[1]);
        if (kind == 0 || apart < 2.5 || sx < 8 || sy < 8 || sx > 892 || sy > 692) continue;
        ++seen;
        const auto& colour = kColours.at(kind);
        const double luma = 0.3 * colour[0] + 0.59 * colour[1] + 0.11 * colour[2];
        const auto grey = [&](std::size_t k) {
          return static_cast<int>(std::lround(0.55 * luma + 0.45 * kColours[0].at(k)));
        };
        if (browser::difference(picture.at(sx, sy), {grey(0), grey(1), grey(2)}) <= 5) continue;
        if (++wrong <= kToldOf)
          ADD_FAILURE() << fmt::format("class {} at {:.1f}, {:.1f} is ", kind, sx, sy)
                        << ::testing::PrintToString(picture.at(sx, sy)) << " and not " << grey(0);
      }
    return {wrong, seen};
  }

  std::optional<DemoDrive> drive;
  std::optional<Browser> page;
};

TEST_F(PageOfTheStack, ComesToTheMapFileThoughTheViewerAndSemanticMapWereKilled) {
  ASSERT_TRUE(drive->wait_for_scans(60)) << drive->output();
  page->open(fmt::format("http://127.0.0.1:{}/#theme=light&off=relief.curbs.path.points.markings", kPort));
  ASSERT_TRUE(page->comes_to("curbstone.world.tiles.size > 50", kPagePatience))
      << page->evaluate("document.body.innerText");
  const double run = page->evaluate("curbstone.world.run");
  ASSERT_TRUE(drive->kill_and_see_it_come_back("viewer")) << drive->output();
  EXPECT_TRUE(
      page->comes_to(fmt::format("curbstone.world.run !== {} && curbstone.world.tiles.size > 50", run), kPagePatience));
  ASSERT_TRUE(drive->kill_and_see_it_come_back("semantic_map")) << drive->output();
  page->pass(3);

  // Nothing new is measured: the map comes to its end, on the page and in the file.
  send_to_emulator(SIGSTOP);
  ASSERT_TRUE(page->comes_to("document.getElementById('status').textContent === 'Stale'", kPagePatience))
      << page->evaluate("document.getElementById('status').textContent");
  EXPECT_TRUE(becomes_the_file()) << other_tiles() << " tiles are other";
  EXPECT_GT(page->evaluate("curbstone.world.tiles.size").get<int>(), 100);
  EXPECT_GT(curbs_on_the_page(), 0.95);

  page->evaluate(
      fmt::format("location.hash = 'at={},{},24,0&follow=0&theme=light&off=relief.curbs.path.points.markings'",
                  drive->pose.map_base_position[0] - 4, drive->pose.map_base_position[1]));
  page->pass(1);
  if (const char* const folder = std::getenv("CURBSTONE_TEST_PICTURES"))
    page->save_picture(std::string(folder) + "/page_of_the_stack.png");
  const auto [wrong, seen] = wrong_and_seen_cells();
  EXPECT_GT(seen, 5000);
  EXPECT_EQ(wrong, 0) << "of " << seen;
  EXPECT_THAT(page->complaints(), ::testing::IsEmpty());
}

}  // namespace
}  // namespace curbstone::system_test
