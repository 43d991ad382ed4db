#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "common/time/clock.hpp"
#include "tests/services/viewer/page/page_on_a_bus.hpp"

namespace curbstone::viewer {
namespace {

using ::testing::HasSubstr;

constexpr const char* kPlainMap = "follow=0&theme=light&off=relief.curbs.path.points";
constexpr const char* kPressed = "document.getElementById('follow').getAttribute('aria-pressed')";

class Page : public PageOnABus {
 protected:
  /// 4 x 4 tiles around (0, 0), where four of the page's textures meet; each cell drawn by lot.
  void put_a_motley_map() {
    vehicle_x = 30;  // it would hide cells
    for (int y = -2; y < 2; ++y)
      for (int x = -2; x < 2; ++x) {
        semantic_tile_t tile = tile_of(x, y, 0);
        for (auto& cell : tile.cell_class) cell = static_cast<std::uint8_t>(random_() % 5);
        put(tile);
      }
  }
  /// A road, and beyond y = 0 a pavement 12 cm higher with a curb between.
  void put_a_street() {
    for (int y = -2; y < 2; ++y)
      for (int x = -2; x < 2; ++x) {
        semantic_tile_t tile = tile_of(x, y, semantic_tile_t::ROAD);
        if (y >= 0) std::fill(std::begin(tile.height), std::end(tile.height), std::int16_t{60});
        for (int column = 0; y == 0 && column < kCells; ++column) tile.cell_class[column] = semantic_tile_t::CURB;
        put(tile);
      }
    curb_line_t line = curb_along({-6, -5, -4, -3, -2, -1, 0, 1, 2, 3, 4, 5, 6}, 0, 0.12F);
    line.confidence = 0.9F;
    line.rise = 1;
    send_curbs({line});
  }
  /// With the cards out of the way: on a busy machine a notice comes and goes between the picture and the question of
  /// what it covers.
  int wrong_cells_of_all() {
    browser->evaluate(R"(
        const hide = new CSSStyleSheet();
        hide.replaceSync("body > :not(#map) { visibility: hidden !important; }");
        document.adoptedStyleSheets = [hide];)");
    const Picture picture = browser->picture();
    int wrong = 0, all = 0;
    for (const auto& [key, tile] : tiles) {
      int seen = 0;
      wrong += wrong_cells(tile, picture, &seen);
      all += seen;
    }
    EXPECT_GT(all, 7900);
    return wrong;
  }

  std::mt19937 random_{7};
};

TEST_F(Page, PaintsEachCellInTheColourOfItsClass) {
  put_a_motley_map();
  open(fmt::format("at=0,0,40,0&{}", kPlainMap));
  EXPECT_EQ(wrong_cells_of_all(), 0);

  // Turned.
  open(fmt::format("at=0.4,-0.3,36,0.7&{}", kPlainMap));
  EXPECT_EQ(wrong_cells_of_all(), 0);
}

TEST_F(Page, ShowsNewsOfACellAtOnce) {
  put_a_motley_map();
  open(fmt::format("at=0,0,40,0&{}", kPlainMap));
  semantic_tile_t tile = tiles[{-1, -1}];
  for (auto& cell : tile.cell_class) cell = static_cast<std::uint8_t>(1 + cell % 4);
  put(tile);
  EXPECT_TRUE(browser->comes_to(
      fmt::format("curbstone.world.tileAt(-1, -1).revision === {} && curbstone.world.changed.size === 0",
                  tiles[{-1, -1}].revision)));
  EXPECT_EQ(wrong_cells_of_all(), 0);
}

TEST_F(Page, HasNoSeamsWhereTexturesMeet) {
  vehicle_x = 80;
  for (int y = -8; y < 8; ++y)
    for (int x = -8; x < 8; ++x) put(tile_of(x, y, semantic_tile_t::ROAD));
  for (const double scale : {3.0, 5.3, 7.7}) {  // several cells in a pixel
    open(fmt::format("at=0.13,0.07,{},0&{}", scale, kPlainMap));
    browser->pass(0.3);
    const Picture picture = browser->picture();
    const Spot corner = spot_of(-10, 10), end = spot_of(10, -10);
    int other = 0;
    for (double y = corner.y; y < end.y; ++y)
      for (double x = corner.x; x < end.x; ++x) other += difference(picture.at(x, y), colour_of(1)) > 4 ? 1 : 0;
    EXPECT_EQ(other, 0) << scale;
  }
}

TEST_F(Page, ReliefShadesNoEdgeOfAFlatMap) {
  vehicle_x = 30;
  for (int x = -2; x < 2; ++x) {
    put(tile_of(x, 0, semantic_tile_t::ROAD));
    tiles[{x, 0}].z_origin = 2;
    put(tiles[{x, 0}]);
  }
  open("at=0,1.5,40,0&follow=0&theme=light&off=curbs.path.points");
  const Picture picture = browser->picture();
  int seen = 0;
  for (const auto& [key, tile] : tiles) EXPECT_EQ(wrong_cells(tile, picture, &seen), 0) << tile.tile_x;
}

TEST_F(Page, FollowsTheVehicleUntilItIsDragged) {
  put_a_street();
  speed = 1;
  open("at=0,0,40,0&follow=1");
  EXPECT_TRUE(browser->comes_to("curbstone.camera.x > 0.5"));
  EXPECT_EQ(browser->evaluate(kPressed), "true");

  browser->drag(500, 300, 420, 340);
  EXPECT_EQ(browser->evaluate(kPressed), "false");
  const double held = browser->evaluate("curbstone.camera.x");
  browser->pass(1);
  EXPECT_EQ(browser->evaluate("curbstone.camera.x"), held);

  browser->press('f');
  EXPECT_EQ(browser->evaluate(kPressed), "true");
  EXPECT_TRUE(browser->comes_to("Math.abs(curbstone.camera.x - curbstone.world.state.pose.x) < 0.3"));
}

TEST_F(Page, AClickedCellTellsItsValues) {
  put_a_street();
  semantic_tile_t tile = tile_of(-1, -1, semantic_tile_t::OBSTACLE);
  tile.z_origin = 2;
  const int cell = 12 * kCells + 5;
  tile.height[cell] = 250;  // 2 mm each
  tile.cost[cell] = 254;
  tile.confidence[cell] = 255;
  put(tile);
  open(fmt::format("at=0,0,40,0&{}", kPlainMap));
  const Spot spot = spot_of(-3 + 5.5 * kCell, -3 + 12.5 * kCell);
  browser->click(spot.x, spot.y);
  ASSERT_TRUE(shows("#cell", "Obstacle"));
  const std::string card = text_of("#cell");
  for (const char* words : {"2.500 m", "254, lethal", "100 %", "-1, -1, revision"}) EXPECT_THAT(card, HasSubstr(words));
  browser->evaluate("document.querySelector('#cell button').click()");
  EXPECT_EQ(browser->evaluate("document.getElementById('cell').hidden"), true);
}

TEST_F(Page, AClickedCurbShowsItsCrossSection) {
  put_a_street();
  open("at=0,0,40,0&follow=0&theme=light");
  ASSERT_TRUE(browser->comes_to("curbstone.world.curbs.size === 1"));
  const Spot spot = spot_of(-2.1, 0.05);
  browser->click(spot.x, spot.y);
  ASSERT_TRUE(shows("#cell", "up from the path"));
  EXPECT_THAT(text_of("#cell"), HasSubstr("12 cm"));
  EXPECT_THAT(text_of("#cell"), HasSubstr("12.00 m"));  // of line
  // Cells on the lower side lie at the foot, those beyond it a step higher: the dots show it.
  const auto dots = browser->evaluate(
      "[...document.querySelectorAll('#cell circle')].map(c => [+c.getAttribute('cx'), +c.getAttribute('cy')])");
  ASSERT_GT(dots.size(), 40U);
  const double foot = dots.front()[1], top = dots.back()[1];
  EXPECT_NEAR(foot - top, 0.12 / 0.6 * 96, 0.01);
  for (const auto& dot : dots) EXPECT_NEAR(dot[1].get<double>(), dot[0].get<double>() < 116 ? foot : top, 0.01);
}

TEST_F(Page, PaintOnTheRoadIsDrawnWithItsGapsAndWithItsWidth) {
  put(tile_of(-1, -1, semantic_tile_t::ROAD));
  marking_line_t line{};
  line.type = marking_line_t::DASHED;
  line.width = 0.3F;
  for (const float x : {-2.5F, -1.5F, -1.0F, -0.5F}) {
    line.x.push_back(x);
    line.y.push_back(-1.5F);
    line.z.push_back(0);
  }
  line.painted = {1, 0, 1, 0};
  line.num_points = 4;
  marking_lines_t markings{};
  markings.epoch = epoch();
  markings.box_min[0] = markings.box_min[1] = -20;
  markings.box_max[0] = markings.box_max[1] = 20;
  markings.num_lines = 1;
  markings.lines = {line};
  send("MARKINGS", markings);
  open(fmt::format("at=-1.5,-1.5,80,0&{}", kPlainMap));
  ASSERT_TRUE(browser->comes_to("curbstone.world.markings.size === 1"));
  const Rgb white = {255, 255, 255}, road = colour_of(semantic_tile_t::ROAD);
  const auto is_drawn = [&](double x, double y, const Rgb& colour) {
    const Spot spot = spot_of(x, y);
    return difference(browser->picture().at(static_cast<int>(spot.x), static_cast<int>(spot.y)), colour) < 12;
  };
  ASSERT_TRUE(browser->comes_to("!curbstone.world.markingsChanged"));
  EXPECT_TRUE(is_drawn(-2.0, -1.5, white));
  EXPECT_TRUE(is_drawn(-2.0, -1.38, white)) << "to scale: 30 cm";
  EXPECT_TRUE(is_drawn(-2.0, -1.2, road));
  EXPECT_TRUE(is_drawn(-1.25, -1.5, road)) << "a gap";
  EXPECT_TRUE(is_drawn(-0.75, -1.5, white));
  browser->evaluate("[...document.querySelectorAll('#layers label')].find(l => l.innerText === 'Paint').click()");
  EXPECT_TRUE(is_drawn(-2.0, -1.5, road)) << "its layer is off";
}

TEST_F(Page, TheLocalizedPoseIsAVehicleOfItsOwn) {
  put(tile_of(-1, -1, semantic_tile_t::ROAD));
  open("at=0,0,40,0&follow=0&theme=light&off=relief.curbs.path.points.markings");
  map_pose_t pose{};
  pose.utime = wall_clock();
  pose.epoch = epoch();
  pose.map_base_position[0] = 4;
  pose.map_base_position[1] = -3;
  pose.map_base_orientation[0] = pose.map_odom_orientation[0] = 1;
  pose.flags = map_pose_t::REGISTERED;
  send("LOCALIZED_POSE", pose);
  ASSERT_TRUE(browser->comes_to("curbstone.world.state.localized?.here"));
  const Rgb teal = {0, 133, 122};
  const auto is_drawn = [&] {
    const Spot spot = spot_of(4 - 0.6, -3 + 0.45);  // on its body, beside the arrow
    return difference(browser->picture().at(static_cast<int>(spot.x), static_cast<int>(spot.y)), teal) < 12;
  };
  EXPECT_TRUE(is_drawn());
  browser->evaluate("[...document.querySelectorAll('#layers label')].find(l => l.innerText === 'Localizer').click()");
  EXPECT_FALSE(is_drawn());
}

TEST_F(Page, MeasuresBetweenTwoPlaces) {
  put_a_street();
  open("at=0,0,40,0&follow=0");
  browser->press('m');
  ASSERT_TRUE(shows("#ruler", "Click a place"));
  const Spot from = spot_of(-2.0, -1.5), to = spot_of(-2.0, 1.5);
  browser->click(from.x, from.y);
  ASSERT_TRUE(shows("#ruler", "other place"));
  browser->click(to.x, to.y);
  ASSERT_TRUE(shows("#ruler", "3.00 m"));
  EXPECT_THAT(text_of("#ruler"), HasSubstr("+12 cm"));
  EXPECT_THAT(text_of("#ruler"), HasSubstr("4.0 %"));
  EXPECT_EQ(browser->evaluate("document.getElementById('cell').hidden"), true);  // no cell was picked
  browser->press('m');
  EXPECT_EQ(browser->evaluate("document.getElementById('ruler').hidden"), true);
}

TEST_F(Page, SavesWhatIsSeenAsAPicture) {
  put_a_motley_map();
  open(fmt::format("at=0,0,40,0&{}", kPlainMap));
  const curbstone::test::TemporaryFolder folder;
  browser->save_to(folder.path().string());
  browser->evaluate("document.getElementById('save').click()");
  std::string file;
  for (int i = 0; i < 500 && file.empty(); ++i) {
    browser->pass(0.02);
    for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
      if (entry.path().extension() == ".png") file = entry.path().string();
  }
  ASSERT_FALSE(file.empty());
  std::ifstream in(file, std::ios::binary);
  const Picture saved(std::string(std::istreambuf_iterator<char>(in), {}));
  int seen = 0;
  EXPECT_EQ(wrong_cells(tiles[{-1, -1}], saved, &seen), 0);
  EXPECT_GT(seen, 400);
}

TEST_F(Page, AProcessThatLosesMessagesShowsHowMany) {
  put_a_street();
  open("at=0,0,40,0&follow=0");
  service_status_t status{};
  status.service = "lidar";
  status.version = "0.2.0";
  status.counter_name = {"packets", "dropped.kernel"};
  status.num_counters = 2;
  for (int second = 1; second <= 4; ++second) {
    status.utime = status.uptime = second * 1'000'000;
    status.counter_value = {750 * second, second < 3 ? 0 : 30 * (second - 2)};
    send("SERVICE_STATUS", status);
    ASSERT_TRUE(browser->comes_to(fmt::format("curbstone.world.services[0]?.uptime >= {}", second)));
    browser->pass(0.6);  // the page writes them twice a second
  }
  EXPECT_TRUE(shows("#services", "30/s dropped: kernel")) << text_of("#services");
  if (HasFailure()) browser->save_picture(::testing::TempDir() + "page_losses.png");
  EXPECT_TRUE(browser->comes_to(
      "document.querySelector('#services .spark polyline').getAttribute('points').split(' ').length === 4"));
}

TEST_F(Page, TheViewIsInTheAddress) {
  put_a_street();
  open("at=1.5,-0.5,60,0&follow=0&colour=height&theme=dark&off=points");
  EXPECT_NEAR(browser->evaluate("curbstone.camera.scale").get<double>(), 60, 0.01);
  browser->press('+');
  EXPECT_TRUE(browser->comes_to("location.hash.includes('at=1.5')&&location.hash.includes(',90.00,')"))
      << browser->evaluate("location.hash");
  const std::string hash = browser->evaluate("location.hash");
  for (const char* words : {"colour=height", "theme=dark", "off=points", "follow=0"})
    EXPECT_THAT(hash, HasSubstr(words));
}

TEST_F(Page, NoCardLiesOnAnotherOnAnyScreen) {
  put_a_street();
  open("at=0,0,40,0&follow=1");
  browser->move(300, 300);  // its place is written beside the scale
  for (const auto& [width, height, touch] : {std::tuple{1600, 900, false},
                                             {1280, 800, false},
                                             {1024, 768, true},
                                             {1000, 700, false},
                                             {900, 700, true},
                                             {834, 1112, true},
                                             {820, 1180, true},
                                             {844, 390, true},
                                             {667, 375, true},
                                             {740, 360, true},
                                             {390, 844, true},
                                             {360, 640, true}}) {
    browser->resize(width, height, touch);
    send_playback();
    ASSERT_TRUE(browser->comes_to("!document.getElementById('timeline').hidden"));
    const auto overlaps = browser->evaluate(R"((() => {
      const boxes = ["bar", "tools", "timeline", "rule", "place", "panel"].map(id => [id, document.getElementById(id).getBoundingClientRect()]);
      return boxes.flatMap(([a, p], i) => boxes.slice(i + 1).filter(([b, q]) =>
        p.left < q.right && q.left < p.right && p.top < q.bottom && q.top < p.bottom).map(([b]) => a + " " + b))
        .concat(boxes.filter(([id, b]) => b.left < -0.5 || b.top < -0.5 || b.right > innerWidth + 0.5).map(([id]) => id + " leaves the screen"));
    })())");
    EXPECT_EQ(overlaps.size(), 0U) << width << " x " << height << ": " << overlaps;
    EXPECT_GT(browser->evaluate("document.getElementById('position').clientWidth").get<double>(), 150)
        << width << " x " << height << ": a finger can place it";
    if (HasFailure()) browser->save_picture(::testing::TempDir() + fmt::format("page_{}.png", width));
  }
}

}  // namespace
}  // namespace curbstone::viewer
