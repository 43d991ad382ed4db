// Maps far from their origin, and large ones.
#include <fmt/format.h>

#include "tests/services/viewer/page/page_on_a_bus.hpp"

namespace curbstone::viewer {
namespace {

constexpr int kFar = 33'333;  // tiles: 100 km

class PageFar : public PageOnABus {
 protected:
  /// A board of roads and curbs, so that a cell drawn beside its place has another colour.
  void put_board(int x, int y) {
    semantic_tile_t tile = tile_of(x, y, semantic_tile_t::ROAD);
    for (int i = 0; i < kCells * kCells; i += 2) tile.cell_class[i] = semantic_tile_t::CURB;
    put(tile);
  }
  void open_far(double scale, const std::string& more) {
    vehicle_x = 3 * kFar + 30;
    put_board(kFar, -kFar);
    open(fmt::format("at={},{},{},0&follow=0&theme=light{}", 3 * kFar + 1.5, -3 * kFar + 1.5, scale, more));
  }
};

TEST_F(PageFar, EachCellIsWhereItIs) {
  for (const double scale : {30.0, 190.0, 750.0}) {
    open_far(scale, "&off=relief.curbs.path.points");
    ASSERT_TRUE(shows("#latency", "from sensor to screen")) << "until then the card grows, over cells that counted";
    int seen = 0;
    EXPECT_EQ(wrong_cells(tiles.begin()->second, browser->picture(), &seen), 0) << scale << " pixels per m";
    EXPECT_GT(seen, 20);
  }
}

TEST_F(PageFar, AMarkIsOnItsCell) {
  open_far(750, "&off=relief.curbs.path.points.grid");
  const double x = 3 * kFar + 1.5, y = -3 * kFar + 1.5;  // the middle of its cell
  const Spot middle = spot_of(x, y);
  browser->click(middle.x, middle.y);
  ASSERT_TRUE(shows("#cell", "Place"));
  const Spot left = spot_of(x - 0.06, y), up = spot_of(x, y + 0.06);
  const Picture picture = browser->picture();
  constexpr Rgb kMark = {214, 36, 127};
  EXPECT_LT(difference(picture.at(left.x, left.y), kMark), 8) << "the left edge of its square";
  EXPECT_LT(difference(picture.at(up.x, up.y), kMark), 8);
}

TEST_F(PageFar, TheTiltedGroundStandsStillWhileTheViewMovesByAPixel) {
  open_far(400, "&tilt=50&off=relief.curbs.path.points");
  ASSERT_TRUE(browser->comes_to("curbstone.camera.isTilted"));
  const Spot spot = spot_of(3 * kFar + 1.5, -3 * kFar + 1.5);
  const auto edge = [&] {  // where the colour changes to the right of the middle, pixels
    const Picture picture = browser->picture();
    const Rgb here = picture.at(spot.x, spot.y);
    int x = 0;
    while (x < 100 && difference(picture.at(spot.x + x, spot.y), here) < 60) ++x;
    return x;
  };
  const int before = edge();
  browser->evaluate("curbstone.camera.x += 0.005, curbstone.redraw()");  // 2 pixels
  browser->pass(0.4);
  EXPECT_NEAR(edge(), before - 2, 1);
}

TEST_F(PageFar, AMapOfTenKilometresIsShownWhole) {
  for (const int x : {0, 1111, 2222, 3333}) put_board(x, 0);
  open("theme=light&off=relief");
  browser->evaluate("document.getElementById('whole').click()");
  for (const int x : {0, 9999}) {
    const Spot spot = spot_of(x, 0);
    EXPECT_GT(spot.x, 0) << x;
    EXPECT_LT(spot.x, 940) << x;
  }
  EXPECT_TRUE(shows("#rule", "km"));
}

/// A page that is seen from afar has a picture of its own.
class PageFromAfar : public PageOnABus {
 protected:
  static constexpr const char* kAfar = "at=1.5,1.5,2.4,0&follow=0&theme=light&off=relief.curbs.path.points&colour=";
  static constexpr const char* kClose = "at=1.5,1.5,4,0&follow=0&theme=light&off=relief.curbs.path.points&colour=";

  /// 3 x 3 equal tiles, minutes old: while a picture is waited for, the colour of what is new changes.
  void put_field(std::int8_t cell_class) {
    vehicle_x = 60;
    for (int i = 0; i < 9; ++i) {
      semantic_tile_t tile = tile_of(i % 3 - 1, i / 3 - 1, cell_class);
      tile.utime -= 300'000'000;
      std::fill(std::begin(tile.cost), std::end(tile.cost), std::uint8_t{90});
      std::fill(std::begin(tile.confidence), std::end(tile.confidence), std::uint8_t{140});
      put(tile);
    }
  }
  Rgb middle() {
    EXPECT_TRUE(browser->comes_to("curbstone.world.changed.size === 0"));
    browser->pass(0.2);
    const Spot spot = spot_of(1.5, 1.5);
    return browser->picture().at(spot.x, spot.y);
  }
  /// The ramp of the heights fits the view a moment later.
  void await_range(const std::string& mode) {
    if (mode == "height") {
      EXPECT_TRUE(shows("#legend", "0.5 m"));
    }
  }
  int pages_close() {
    return browser->evaluate("[...curbstone.ground.pages.all.values()].filter(page => page.close).length");
  }
};

TEST_F(PageFromAfar, LooksAsItDoesCloseUp) {
  put_field(semantic_tile_t::ROAD);
  for (const std::string mode : {"class", "height", "cost", "confidence", "age", "paper"}) {
    open(kClose + mode);
    await_range(mode);
    const Rgb close = middle();
    EXPECT_EQ(pages_close(), 4) << "about the origin";
    open(kAfar + mode);
    await_range(mode);
    const Rgb afar = middle();
    EXPECT_LE(difference(afar, close), 4)
        << mode << ": " << ::testing::PrintToString(close) << ", from afar " << ::testing::PrintToString(afar);
    EXPECT_EQ(pages_close(), 0) << "it needs no textures of cells";
  }
}

TEST_F(PageFromAfar, ShowsNewsOfACell) {
  put_field(semantic_tile_t::ROAD);
  open(kAfar + std::string("class"));
  EXPECT_LE(difference(middle(), colour_of(semantic_tile_t::ROAD)), 4);
  put_field(semantic_tile_t::CURB);
  EXPECT_TRUE(browser->comes_to("curbstone.world.tileAt(0, 0).classes[0] === 2"));
  EXPECT_LE(difference(middle(), colour_of(semantic_tile_t::CURB)), 4);
  begin_epoch();
  put(tile_of(40, 40, semantic_tile_t::ROAD));
  EXPECT_TRUE(browser->comes_to("curbstone.world.tiles.size === 1"));
  EXPECT_LE(difference(middle(), colour_of(0)), 4) << "of the map before nothing is left";
}

TEST_F(PageFromAfar, KeepsTheCellsOfAFewPagesOnly) {
  constexpr int kPages = 60, kAside = 32;
  for (int i = 0; i < kPages; ++i) put(tile_of(i * kAside, 0, semantic_tile_t::ROAD));
  open(kClose + std::string("class"));
  for (int i = 0; i < kPages; i += 3) {
    browser->evaluate(fmt::format("curbstone.camera.x = {}, curbstone.redraw()", i * kAside * 3));
    browser->pass(0.1);
  }
  EXPECT_LE(pages_close(), 40);
  EXPECT_GT(pages_close(), 0);
  browser->evaluate("curbstone.camera.x = 1.5, curbstone.redraw()");  // whose cells were given up meanwhile
  EXPECT_LE(difference(middle(), colour_of(semantic_tile_t::ROAD)), 4);
}

}  // namespace
}  // namespace curbstone::viewer
