// The cross-section of a curb, and what its sides are.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "tests/services/viewer/page/page_on_a_bus.hpp"

namespace curbstone::viewer {
namespace {

using ::testing::HasSubstr;

/// A road that rises by 2 % to a curb of 12 cm along y = 0, and a pavement that falls by 3 % away from it.
class PageCut : public PageOnABus {
 protected:
  static double ground(double y) { return y < 0 ? 0.02 * y : 0.12 - 0.03 * y; }

  void put_a_sloping_street(bool with_a_wall) {
    for (int y = -2; y < 2; ++y)
      for (int x = -2; x < 2; ++x) {
        semantic_tile_t tile = tile_of(x, y, semantic_tile_t::ROAD);
        for (int i = 0; i < kCells * kCells; ++i) {
          const double place = 3 * y + (i / kCells + 0.5) * kCell;
          const bool is_wall = with_a_wall && place > 1.08;
          tile.height[i] = static_cast<std::int16_t>(std::lround((ground(place) + (is_wall ? 0.4 : 0)) / 0.002));
          if (is_wall) tile.cell_class[i] = semantic_tile_t::WALL;
        }
        put(tile);
      }
    curb_line_t line = curb_along({-6, -5, -4, -3, -2, -1, 0, 1, 2, 3, 4, 5, 6}, 0, 0.1F);
    line.confidence = 0.9F;
    line.rise = 1;
    send_curbs({line});
  }
  void select_the_curb() {
    vehicle_x = 5;
    open("at=0,0,40,0&follow=0&theme=light");
    ASSERT_TRUE(browser->comes_to("curbstone.world.curbs.size === 1"));
    const Spot spot = spot_of(-2.1, 0.05);
    browser->click(spot.x, spot.y);
    ASSERT_TRUE(shows("#cell", "up from the path"));
  }
  /// A number in the card, behind a term. Per cent and cm as they are shown.
  double value_of(const std::string& term, int which = 0) {
    return browser->evaluate(fmt::format(
        "(() => {{ const term = [...document.querySelectorAll('#cell dt')].find(t => t.textContent === '{}');"
        " return term ? parseFloat(term.nextSibling.textContent.split(', ')[{}].replace('−', '-')) : -1000; }})()",
        term, which));
  }
  void expect_the_true_sides() {
    EXPECT_NEAR(value_of("Step fitted here"), 12, 0.5) << "cm, though the map says 10";
    EXPECT_NEAR(value_of("Slope below, above", 0), 2, 0.3);
    EXPECT_NEAR(value_of("Slope below, above", 1), -3, 0.3);
    // As drawn: 232 pixels are 3 m, 96 are 0.6 m.
    const auto line = browser->evaluate(
        "document.querySelector('#cell .step').getAttribute('points').split(' ').map(p => p.split(',').map(Number))");
    ASSERT_EQ(line.size(), 4U);
    const auto slope = [&](std::size_t from, std::size_t to) {
      const double across = (line[to][0].get<double>() - line[from][0].get<double>()) * 3 / 232;
      return (line[from][1].get<double>() - line[to][1].get<double>()) * 0.6 / 96 / across;
    };
    EXPECT_NEAR(slope(0, 1), 0.02, 0.003);
    EXPECT_NEAR(slope(2, 3), -0.03, 0.003);
    EXPECT_NEAR((line[1][1].get<double>() - line[2][1].get<double>()) * 0.6 / 96, 0.12, 0.005);
  }
};

TEST_F(PageCut, ALineIsFittedToEachSideAndTheStepIsReadAtTheFoot) {
  put_a_sloping_street(false);
  select_the_curb();
  EXPECT_THAT(text_of("#cell figcaption"), HasSubstr("fitted to both sides"));
  expect_the_true_sides();
  keep_picture("cut");
}

TEST_F(PageCut, AWallBesideItDoesNotPullTheLine) {
  put_a_sloping_street(true);
  select_the_curb();
  expect_the_true_sides();
  keep_picture("cut_wall");
}

TEST_F(PageCut, ThePointsAreMoreThanTheCells) {
  put_a_sloping_street(false);
  select_the_curb();
  browser->pass(0.5);  // until the viewer has heard what the page wants
  // Points of a curb 20 cm high between level sides, where the cells say otherwise.
  for (const int ty : {-1, 0}) {
    map_points_t points{};
    points.epoch = epoch();
    points.tile_x = -1;
    points.tile_y = ty;
    for (int x = 5; x < 1500; x += 50)
      for (int y = 5; y < 1500; y += 50) {
        points.x.push_back(static_cast<std::int16_t>(x));
        points.y.push_back(static_cast<std::int16_t>(y));
        points.z.push_back(ty < 0 ? 0 : 100);
        points.intensity.push_back(60);
      }
    points.num_points = static_cast<std::int32_t>(points.x.size());
    send("MAP_POINTS", points);
  }
  ASSERT_TRUE(browser->comes_to("document.querySelectorAll('#cell rect').length > 30"));
  EXPECT_NEAR(value_of("Step fitted here"), 20, 0.5);
  EXPECT_NEAR(value_of("Slope below, above", 0), 0, 0.3);
  keep_picture("cut_points");
}

TEST_F(PageCut, ASideThatNobodySawLeavesTheMapsStep) {
  put_a_sloping_street(false);
  for (int x = -2; x < 2; ++x) {
    semantic_tile_t tile = tiles[{x, 0}];
    std::fill(std::begin(tile.height), std::end(tile.height), semantic_tile_t::NO_HEIGHT);
    put(tile);
  }
  select_the_curb();
  EXPECT_THAT(text_of("#cell figcaption"), HasSubstr("the map's step"));
  EXPECT_EQ(value_of("Step fitted here"), -1000) << "no such row";
}

TEST_F(PageCut, AClickedCellCountsItsPointsAndTheirHeights) {
  put_roads(-1, 1);
  vehicle_x = 5;
  open("at=0,0,40,0&follow=0&theme=light");
  const Spot spot = spot_of(-1.5, -1.5);  // the cell from -1.56 to -1.44
  browser->click(spot.x, spot.y);
  ASSERT_TRUE(shows("#cell", "Road"));
  EXPECT_THAT(text_of("#cell"), ::testing::Not(HasSubstr("Points in it"))) << "nobody has sent any";
  browser->pass(0.5);
  map_points_t points{};
  points.epoch = epoch();
  points.tile_x = points.tile_y = -1;
  // Steps of 2 mm from the tile's corner. The last two are of the cells beside it.
  points.x = {750, 750, 725, 690, 790};
  points.y = {750, 750, 775, 750, 750};
  points.z = {0, 100, 250, 0, 0};
  points.intensity = {9, 9, 9, 9, 9};
  points.num_points = 5;
  send("MAP_POINTS", points);
  ASSERT_TRUE(shows("#cell", "Points in it")) << text_of("#cell");
  EXPECT_THAT(text_of("#cell"), HasSubstr("3, 0.00 to 0.50 m"));
  keep_picture("cell_points");
}

}  // namespace
}  // namespace curbstone::viewer
