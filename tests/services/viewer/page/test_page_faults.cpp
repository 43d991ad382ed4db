#include <fmt/format.h>

#include <utility>
#include "tests/services/viewer/page/page_on_a_bus.hpp"

namespace curbstone::viewer {
namespace {

constexpr const char* kPlain = "at=0,0,40,0&follow=0&theme=light&off=relief.curbs.path.points";
constexpr double kPlace = -1.3;  // m, x and y: in the map

class PageFaults : public PageOnABus {
 protected:
  void put_walls() {
    browser->resize(640, 520);  // drawn without a graphics card: what is smaller is drawn sooner
    vehicle_x = 30;             // it would hide cells
    for (int y = -1; y < 1; ++y)
      for (int x = -1; x < 1; ++x) put(tile_of(x, y, semantic_tile_t::WALL));
  }
  bool is_coloured() {
    const Spot spot = spot_of(kPlace, kPlace);
    const Rgb colour = browser->picture().at(spot.x, spot.y);
    return difference(colour, {colour[0], colour[0], colour[0]}) > 20;
  }
};

TEST_F(PageFaults, ADeadBusLooksDead) {
  put_walls();
  open(kPlain);
  ASSERT_TRUE(shows("#status", "Live"));
  EXPECT_TRUE(is_coloured());

  bus_is_alive = false;
  EXPECT_TRUE(shows("#status", "Silent"));
  EXPECT_TRUE(shows("#curtain", "this is how it was"));
  browser->pass(0.3);
  EXPECT_FALSE(is_coloured());

  bus_is_alive = true;
  ASSERT_TRUE(shows("#status", "Live"));
  browser->pass(0.3);
  EXPECT_TRUE(is_coloured());
}

TEST_F(PageFaults, AMapThatNobodyMakesAnyMoreIsGreyUnderAVehicleThatLives) {
  map_speaks = map_announces = true;
  put_walls();
  vehicle_x = 3;
  open(kPlain);
  browser->pass(4);
  EXPECT_EQ(text_of("#status"), "Live") << "at a standstill no tiles come, but semantic_map tells that it is there";
  EXPECT_TRUE(is_coloured());

  map_speaks = map_announces = false;
  ASSERT_TRUE(shows("#status", "Map stale"));
  EXPECT_TRUE(shows("#curtain", "semantic_map has been silent for"));
  browser->pass(0.3);
  EXPECT_FALSE(is_coloured());
  const Spot body = spot_of(vehicle_x - 0.6, 0.45);  // beside the arrow
  EXPECT_LE(difference(browser->picture().at(body.x, body.y), {214, 36, 127}), 8);
  keep_picture("map_stale");

  map_speaks = map_announces = true;
  ASSERT_TRUE(shows("#status", "Live"));
  browser->pass(0.3);
  EXPECT_TRUE(is_coloured());
}

TEST_F(PageFaults, AMapIsAliveAsLongAsOneOfItsTwoVoicesIsHeard) {
  put_walls();
  open(kPlain);
  map_announces = true;
  browser->pass(4);
  EXPECT_EQ(text_of("#status"), "Live");
  std::swap(map_announces, map_speaks);
  browser->pass(4);
  EXPECT_EQ(text_of("#status"), "Live");
  map_speaks = false;
  EXPECT_TRUE(shows("#status", "Map stale"));
}

TEST_F(PageFaults, ALocalizerThatFellSilentIsNoVehicleAnyMore) {
  put_walls();
  open(kPlain);
  localized_x = 3;
  const auto is_drawn = [&] {
    const Spot body = spot_of(3 - 0.6, 0.45);
    return difference(browser->picture().at(body.x, body.y), {0, 133, 122}) < 12;
  };
  ASSERT_TRUE(browser->comes_to("curbstone.world.state.localized?.here"));
  browser->pass(0.5);
  ASSERT_TRUE(is_drawn());
  localized_x.reset();
  EXPECT_TRUE(browser->comes_to("document.getElementById('facts').textContent.includes('silent for')"));
  browser->pass(0.3);
  EXPECT_EQ(text_of("#status"), "Live");
  EXPECT_FALSE(is_drawn());
}

TEST_F(PageFaults, AViewerThatWasKilledIsMissedAndComesBackWithTheMap) {
  put_walls();
  open(kPlain);
  stop_viewer();
  ASSERT_TRUE(shows("#status", "No connection"));
  browser->pass(0.3);
  EXPECT_FALSE(is_coloured());

  tiles[{-1, -1}].cell_class[0] = semantic_tile_t::CURB;  // while it was away
  start_viewer(config.port);
  repeat_tiles();
  ASSERT_TRUE(shows("#status", "Live"));
  ASSERT_TRUE(browser->comes_to("curbstone.world.tiles.size === 4 && curbstone.world.tileAt(-1, -1).classes[0] === 2"));
  browser->pass(0.3);
  EXPECT_TRUE(is_coloured());
}

TEST_F(PageFaults, AMapThatBeginsAgainReplacesTheOldOne) {
  put_walls();
  open(kPlain);
  begin_epoch();
  put(tile_of(5, 5, semantic_tile_t::ROAD));
  EXPECT_TRUE(browser->comes_to("curbstone.world.tiles.size === 1 && curbstone.world.tileAt(5, 5)"));
}

TEST_F(PageFaults, AGraphicsContextThatWasLostIsDrawnAgain) {
  put_walls();
  open(kPlain);
  browser->evaluate(
      "window.lost = document.getElementById('ground').getContext('webgl2').getExtension('WEBGL_lose_context')");
  browser->evaluate("lost.loseContext()");
  browser->pass(0.3);
  EXPECT_FALSE(is_coloured());
  browser->evaluate("lost.restoreContext()");
  EXPECT_TRUE(browser->comes_to("!document.getElementById('ground').getContext('webgl2').isContextLost()"));
  browser->pass(0.5);
  const Picture picture = browser->picture();
  int seen = 0;
  EXPECT_EQ(wrong_cells(tiles[{-1, -1}], picture, &seen), 0);
  EXPECT_GT(seen, 500);
}

TEST_F(PageFaults, APageThatDoesNotReadGetsTheMapAsItIsWhenItWakes) {
  put_walls();
  open(kPlain);
  // A tab in the background draws nothing until it is in front again, so it acknowledges nothing.
  browser->evaluate(
      "window.animate = requestAnimationFrame; window.held = []; window.requestAnimationFrame = f => held.push(f)");
  for (int n = 0; n < 200; ++n) {
    semantic_tile_t tile = tiles[{0, 0}];
    tile.cell_class[n] = semantic_tile_t::OBSTACLE;
    put(tile);
    browser->pass(0.01);
  }
  browser->evaluate("window.requestAnimationFrame = animate; for (const drawing of held) animate(drawing); 0");
  ASSERT_TRUE(browser->comes_to("curbstone.world.tiles.size === 4 && curbstone.world.tileAt(0, 0).classes[199] === 3"));
  EXPECT_TRUE(shows("#status", "Live"));
}

/// As when a shader is compiled in software: no frame comes while one is drawn.
TEST_F(PageFaults, APageThatWasLongInDrawingHasNotLostItsConnection) {
  put(tile_of(0, 0, semantic_tile_t::ROAD));
  open("at=0,0,14,0&follow=0&theme=light");
  ASSERT_TRUE(shows("#status", "Live"));
  browser->evaluate(
      "(() => { window.words = []; const status = document.getElementById('status');"
      " new MutationObserver(() => words.push(status.textContent)).observe(status, { childList: true });"
      " const gl = document.getElementById('ground').getContext('webgl2'), clear = gl.clear.bind(gl); window.long = 3;"
      " gl.clear = what => { clear(what); const end = performance.now() + 3000;"
      " while (long > 0 && performance.now() < end); --long; }; return 0; })()");
  ASSERT_TRUE(browser->comes_to("long <= 0"));
  browser->pass(1);
  EXPECT_EQ(browser->evaluate("words.join()").get<std::string>(), "");
}

}  // namespace
}  // namespace curbstone::viewer
