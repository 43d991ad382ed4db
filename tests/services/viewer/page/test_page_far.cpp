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

}  // namespace
}  // namespace curbstone::viewer
