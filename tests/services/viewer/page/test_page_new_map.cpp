// Another map in a frame of its own: what the page says of it, and what it forgets.
#include "tests/services/viewer/page/page_on_a_bus.hpp"

namespace curbstone::viewer {
namespace {

class PageNewMap : public PageOnABus {
 protected:
  void drive_away() {
    browser->resize(1000, 700);
    vehicle_x = 60;
    for (int x = 18; x < 23; ++x) put(tile_of(x, 0, semantic_tile_t::ROAD));
    open("theme=light&off=relief.points");
    ASSERT_TRUE(shows("#status", "Live"));
  }
  /// The vehicle drove on lost, and is the origin of another map.
  void begin_new_map() {
    vehicle_x = 0;
    begin_epoch();
  }
  void send_reason() {
    service_status_t status{};
    status.service = "mapper";
    status.num_faults = 1;
    status.fault = {"a new map begins: the vehicle was lost, which stays in maps/monday"};
    send("SERVICE_STATUS", status);
  }
};

TEST_F(PageNewMap, IsSaidInWordsWithTheMappersReason) {
  drive_away();
  begin_new_map();
  EXPECT_TRUE(shows("#curtain", "A new map began")) << text_of("body");
  send_reason();
  EXPECT_TRUE(shows("#curtain", "the vehicle was lost, which stays in maps/monday")) << text_of("#curtain");
  put(tile_of(0, 0, semantic_tile_t::ROAD));
  EXPECT_TRUE(shows("#curtain", "A new map began")) << "while it grows";
  EXPECT_TRUE(browser->comes_to("Math.abs(curbstone.camera.x) < 1")) << "it follows the vehicle there";
}

TEST_F(PageNewMap, IsNoWayThatTheVehicleDrove) {
  drive_away();
  // The page draws the vehicle on its way from one pose to the next: here there is none.
  browser->evaluate(R"((() => {
    window.between = 0;
    const look = () => {
      const { x } = curbstone.camera;
      if (x > 2 && x < 58) ++between;
      requestAnimationFrame(look);
    };
    look();
    new MutationObserver(() => {
      const speed = [...document.querySelectorAll('#facts dd')].map(dd => parseFloat(dd.innerText))[0];
      window.fastest = Math.max(window.fastest ?? 0, speed || 0);
    }).observe(document.getElementById('facts'), { childList: true });
  })())");
  begin_new_map();
  ASSERT_TRUE(browser->comes_to("Math.abs(curbstone.camera.x) < 1"));
  browser->pass(1.2);
  EXPECT_EQ(browser->evaluate("between"), 0);
  EXPECT_LT(browser->evaluate("fastest").get<double>(), 10) << "m/s";
}

TEST_F(PageNewMap, HasNothingOfWhatWasMeasuredAndAskedInTheOneBefore) {
  drive_away();
  browser->press('m');
  for (const double x : {58.0, 62.0}) {
    const Spot spot = spot_of(x, 1);
    browser->click(spot.x, spot.y);
  }
  ASSERT_TRUE(shows("#ruler", "Distance"));
  begin_new_map();
  for (int x = 18; x < 23; ++x) put(tile_of(x, 0, semantic_tile_t::WALL));
  EXPECT_TRUE(browser->comes_to("curbstone.ruler.places.length === 0"));
  EXPECT_TRUE(shows("#ruler", "Click a place")) << "it still measures";
}

TEST_F(PageNewMap, ThatIsNowhereInViewCanBeFound) {
  drive_away();
  browser->drag(400, 400, 380, 400);  // follows no longer
  begin_new_map();
  browser->evaluate("curbstone.camera.x = 900, curbstone.redraw()");
  put(tile_of(0, 0, semantic_tile_t::ROAD));
  EXPECT_TRUE(shows("#curtain", "A new map began"));
  vehicle_x = 90;  // not at its origin: a correction of the map
  begin_epoch();
  put(tile_of(0, 0, semantic_tile_t::ROAD));
  EXPECT_TRUE(shows("#curtain", "No part of the map is in view", 45)) << text_of("#curtain");
  browser->evaluate("document.getElementById('whole').click()");
  EXPECT_TRUE(browser->comes_to("document.getElementById('curtain').hidden"));
}

}  // namespace
}  // namespace curbstone::viewer
