#include <fmt/format.h>

#include "tests/services/viewer/page/page_on_a_bus.hpp"

namespace curbstone::viewer {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kPlainView = "at=0,0,40,0&follow=0&theme=light&off=relief.curbs.path.points";

class PageTilted : public PageOnABus {
 protected:
  /// A road, 2 m up beyond y = 0, with a wall and an obstacle on it.
  void put_a_terrace() {
    vehicle_x = 60;
    for (int y = -3; y < 4; ++y)
      for (int x = -4; x < 4; ++x) {
        semantic_tile_t tile = tile_of(x, y, semantic_tile_t::ROAD);
        if (y >= 0) tile.z_origin = 2;
        if (x == -2 && y == -1) block(tile, semantic_tile_t::WALL);
        if (x == 1 && y == -1) block(tile, semantic_tile_t::OBSTACLE);
        put(tile);
      }
  }
  static void block(semantic_tile_t& tile, std::int8_t cell_class) {
    for (int row = 8; row < 16; ++row)
      for (int column = 8; column < 16; ++column)
        tile.cell_class[row * kCells + column] = static_cast<std::uint8_t>(cell_class);
  }
  /// Where a place at a height is on the screen.
  Spot spot_at(double x, double y, double z) {
    const auto spot = browser->evaluate(fmt::format("curbstone.camera.toScreen({}, {}, {})", x, y, z));
    return {spot[0].get<double>(), spot[1].get<double>()};
  }
  double tilt() { return browser->evaluate("curbstone.camera.tilt"); }
  /// The colour of the class itself, or a side of it in shade.
  static bool is_of(const Rgb& seen, int cell_class) {
    const Rgb full = colour_of(cell_class);
    for (double light = 0.5; light <= 1.1; light += 0.02) {
      const auto at = [&](std::size_t i) { return std::min(255, static_cast<int>(full[i] * light)); };
      if (difference(seen, {at(0), at(1), at(2)}) < 8) return true;
    }
    return false;
  }
};

TEST_F(PageTilted, ShowsGroundAtItsHeightAndBlocksOverIt) {
  put_a_terrace();
  open(fmt::format("{}&tilt=50", kPlainView));
  ASSERT_TRUE(
      browser->comes_to("Math.abs(curbstone.camera.z - 2) < 0.001"));  // turns about the ground under its middle
  browser->pass(0.5);
  const Picture picture = browser->picture();
  const auto at = [&](double x, double y, double z) {
    const Spot spot = spot_at(x, y, z);
    return picture.at(spot.x, spot.y);
  };
  EXPECT_TRUE(is_of(at(0.5, -3, 0), semantic_tile_t::ROAD));
  EXPECT_TRUE(is_of(at(0.5, 2, 2), semantic_tile_t::ROAD));
  // The wall's box is 2 m high, the obstacle's 0.7 m: their tops, their front sides, and what stands behind the wall.
  EXPECT_TRUE(is_of(at(-4.6, -1.6, 2), semantic_tile_t::WALL));
  EXPECT_TRUE(is_of(at(-4.6, -2.04, 1), semantic_tile_t::WALL));
  EXPECT_TRUE(is_of(at(4.4, -1.6, 0.7), semantic_tile_t::OBSTACLE));
  EXPECT_TRUE(is_of(at(4.4, -2.04, 0.35), semantic_tile_t::OBSTACLE));
  EXPECT_FALSE(is_of(at(4.4, -2.04, 2.4), semantic_tile_t::OBSTACLE));
  EXPECT_TRUE(is_of(at(-4.6, -0.9, 0), semantic_tile_t::WALL)) << "the wall hides the ground behind it";
  if (HasFailure()) browser->save_picture(::testing::TempDir() + "page_tilted.png");
}

/// More walls than this machine draws as boxes. The near ones are in a texture that is not the first to be drawn.
TEST_F(PageTilted, ShowsTheNearestWallsAsBoxesWhereThereAreTooMany) {
  vehicle_x = 60;
  for (int y = -8; y < 0; ++y)
    for (int x : {0, 1, 2, 3, -4, -3, -2, -1}) {
      semantic_tile_t tile = tile_of(x, y, semantic_tile_t::ROAD);
      for (int cell = 0; cell < kCells * kCells; ++cell) {
        const int row = cell / kCells, column = cell % kCells;
        const bool is_post = x < 0 && y < -4 && row % 5 == 2 && column % 5 == 2;
        const bool is_thicket = x >= 0 && x < 3 && y == -2 && (row + column) % 2 == 0;
        if (is_post || is_thicket) tile.cell_class[cell] = semantic_tile_t::WALL;
      }
      put(tile);
    }
  open("at=0,-12,30,0&follow=0&theme=light&off=relief.curbs.path.points&tilt=50");
  browser->pass(0.5);
  const Picture picture = browser->picture();
  for (int y = -7; y < -4; ++y)
    for (int x = -3; x < 0; ++x) {
      const Spot side = spot_at(3.0 * x + 12.5 * 0.12, 3.0 * y + 12 * 0.12 - 0.01, 1);
      EXPECT_TRUE(is_of(picture.at(side.x, side.y), semantic_tile_t::WALL)) << x << " " << y;
    }
  keep_picture("nearest_walls");
}

TEST_F(PageTilted, HasNoGapsWhereTexturesMeetOnASlope) {
  vehicle_x = 60;
  for (int y = -3; y < 3; ++y)
    for (int x = -3; x < 3; ++x) {
      semantic_tile_t tile = tile_of(x, y, semantic_tile_t::ROAD);
      tile.z_origin = x < 0 ? 0 : 1;  // a step of 1 m at the border of two textures
      put(tile);
    }
  browser->resize(640, 520);
  open("at=0,0,40,1.5708&follow=0&theme=light&off=relief.curbs.path.points&tilt=60");  // up the step
  browser->pass(0.5);
  const Picture picture = browser->picture();
  int gaps = 0;
  for (double y = -2.5; y < 2.5; y += 0.1)
    for (double z = 0.05; z < 1; z += 0.1) {
      const Spot spot = spot_at(0, y, z);
      gaps += is_of(picture.at(spot.x, spot.y), semantic_tile_t::ROAD) ? 0 : 1;
    }
  EXPECT_EQ(gaps, 0);
  if (HasFailure()) browser->save_picture(::testing::TempDir() + "page_gaps.png");
}

TEST_F(PageTilted, AClickFindsTheCellThatIsSeenThere) {
  put_a_terrace();
  open(fmt::format("{}&tilt=50", kPlainView));
  ASSERT_TRUE(browser->comes_to("Math.abs(curbstone.camera.z - 2) < 0.001"));
  const Spot upper = spot_at(1.5, 4.5, 2);
  browser->click(upper.x, upper.y);
  ASSERT_TRUE(shows("#cell", "2.000 m"));
  EXPECT_THAT(text_of("#cell"), HasSubstr("0, 1, revision"));
}

TEST_F(PageTilted, TiltsByKeyButtonRightDragAndTwoFingers) {
  put_a_terrace();
  open(kPlainView);
  EXPECT_EQ(tilt(), 0);
  browser->press('t');
  EXPECT_TRUE(browser->comes_to("curbstone.camera.tilt > 0.9"));
  EXPECT_TRUE(browser->comes_to("location.hash.includes('tilt=')"));
  browser->evaluate("document.getElementById('tilt').click()");
  EXPECT_TRUE(browser->comes_to("curbstone.camera.tilt === 0"));

  browser->drag(500, 500, 560, 400, true);
  EXPECT_GT(tilt(), 0.4);
  EXPECT_GT(browser->evaluate("curbstone.camera.turn").get<double>(), 0.1);
  browser->drag(500, 300, 500, 700, true);
  EXPECT_EQ(tilt(), 0);

  browser->resize(390, 844, true);
  browser->touch({120, 500, 118, 380}, {260, 500, 262, 380});
  EXPECT_GT(tilt(), 0.3);
  const double scale = browser->evaluate("curbstone.camera.scale"), tilted = tilt();
  browser->touch({150, 400, 60, 400}, {240, 400, 330, 400});
  EXPECT_GT(browser->evaluate("curbstone.camera.scale").get<double>(), 1.5 * scale);
  EXPECT_EQ(tilt(), tilted);
}

TEST_F(PageTilted, TheWholeMapIsTheWholeOfItTiltedToo) {
  for (int x = -12; x < 12; ++x) put(tile_of(x, x / 3, semantic_tile_t::ROAD));
  open(fmt::format("{}&tilt=60&panel=0", kPlainView));
  browser->evaluate("document.getElementById('whole').click()");
  browser->pass(0.5);
  const Picture picture = browser->picture();
  double leftmost = 1e9, rightmost = 0;
  for (const double x : {-36.0, 36.0})
    for (const double y : {-12.0, 12.0}) {
      const Spot spot = spot_at(x, y, 0);
      EXPECT_TRUE(spot.x >= 0 && spot.x < picture.width() && spot.y >= 0 && spot.y < picture.height()) << x << " " << y;
      leftmost = std::min(leftmost, spot.x), rightmost = std::max(rightmost, spot.x);
    }
  EXPECT_GT(rightmost - leftmost, 0.7 * picture.width()) << "and no smaller than it need be";
}

TEST_F(PageTilted, WhatIsDraggedStaysUnderTheMouse) {
  put_a_terrace();
  open("at=0,-3,40,0.4&follow=0&theme=light&tilt=55");
  browser->pass(0.5);
  const auto under = [&](double x, double y) -> std::pair<double, double> {
    const auto place = browser->evaluate(fmt::format("curbstone.camera.toMap({}, {})", x, y));
    return {place[0].get<double>(), place[1].get<double>()};
  };
  const auto before = under(420, 560);
  browser->drag(420, 560, 520, 400);  // away from the step, so that the ground under the middle stays as high
  const auto after = under(520, 400);
  EXPECT_NEAR(before.first, after.first, 0.05);
  EXPECT_NEAR(before.second, after.second, 0.05);
  const Spot back = spot_at(after.first, after.second, browser->evaluate("curbstone.camera.z"));
  EXPECT_NEAR(back.x, 520, 0.5);
  EXPECT_NEAR(back.y, 400, 0.5);
}

TEST_F(PageTilted, IsCoarserOnlyWhileTheUserMovesTheView) {
  put_a_terrace();
  open(fmt::format("{}&tilt=50", kPlainView));
  const std::string is_fine = "document.getElementById('ground').width === innerWidth";
  ASSERT_TRUE(browser->comes_to(is_fine));
  // The page's own callback for the next picture comes before this one.
  const std::string in_a_picture = "curbstone.redraw(); requestAnimationFrame(() => done(" + is_fine + ")); })";
  EXPECT_FALSE(browser->evaluate("new Promise(done => { curbstone.camera.turn += 0.1; " + in_a_picture).get<bool>());
  EXPECT_TRUE(browser->comes_to(is_fine));
  // To follow the vehicle is no haste: that goes on for hours.
  speed = 3;
  browser->evaluate("document.getElementById('follow').click()");
  EXPECT_TRUE(browser->comes_to("curbstone.settings.follow && curbstone.camera.x > 59"));
  browser->pass(0.5);
  for (int i = 0; i < 5; ++i) {
    EXPECT_TRUE(browser->evaluate("new Promise(done => { " + in_a_picture).get<bool>());
    browser->pass(0.1);
  }
}

TEST_F(PageTilted, ACurbThatNobodySawIsARowOfPosts) {
  vehicle_x = 60;
  put_roads(-2, 2);
  std::vector<curb_line_t> curbs;
  for (const float y : {-1.5F, 0.0F, 1.5F}) {  // seen, lowered, inferred
    curb_line_t line = curb_along({-3, -1.1F, 0.3F, 3}, y, 0.3F);
    line.dropped = y == 0 ? 1 : 0;
    line.inferred = y > 1 ? 1 : 0;
    curbs.push_back(line);
  }
  send_curbs(curbs);
  open("at=0,0,60,0&follow=0&theme=light&off=relief.path.points&tilt=50");
  ASSERT_TRUE(browser->comes_to("curbstone.world.curbs.size === 3"));
  browser->pass(0.5);
  keep_picture("curb_walls");
  const Picture picture = browser->picture();
  /// The share of the wall's middle, from end to end, that is drawn.
  const auto share = [&](double y) {
    int drawn = 0;
    for (int i = 0; i < 200; ++i) {
      const Spot spot = spot_at(-2.5 + 0.025 * i, y, 0.15);
      drawn += difference(picture.at(spot.x, spot.y), colour_of(semantic_tile_t::ROAD)) > 40 ? 1 : 0;
    }
    return drawn / 200.0;
  };
  const auto colour = [&](double y) {
    const Spot spot = spot_at(-2.03, y, 0.15);
    return picture.at(spot.x, spot.y);
  };
  EXPECT_EQ(share(-1.5), 1);
  EXPECT_EQ(share(0), 1);
  EXPECT_GT(difference(colour(-1.5), colour(0)), 20) << "a lowered one shows the ground behind it";
  EXPECT_NEAR(share(1.5), 0.4, 0.12);
}

TEST_F(PageTilted, ALostLocalizerSaysSoInWords) {
  put_a_terrace();
  open(fmt::format("{}&tilt=40", kPlainView));
  map_pose_t pose{};
  pose.map_base_position[0] = 4.25;
  pose.map_base_orientation[0] = pose.map_odom_orientation[0] = 1;
  pose.covariance[0] = pose.covariance[7] = 0.04F;
  // Until the page has it: one alone is old before a busy machine has drawn it.
  const auto says_until = [&](const std::string& words) {
    for (int i = 0; i < 300 && text_of("#facts").find(words) == std::string::npos; ++i) {
      ++pose.utime;
      send("LOCALIZED_POSE", pose);
      browser->pass(0.05);
    }
    return text_of("#facts");
  };
  EXPECT_THAT(says_until("in another map"), HasSubstr("4.25, 0.00 m"));
  pose.flags = map_pose_t::LOST;
  EXPECT_THAT(says_until("LOST"), HasSubstr("LOST: its pose is a guess"));
  EXPECT_TRUE(shows("#facts", "silent for"));
  EXPECT_THAT(text_of("#facts"), Not(HasSubstr("LOST")));
}

}  // namespace
}  // namespace curbstone::viewer
