#include <fmt/format.h>

#include <array>
#include <tuple>

#include "tests/services/viewer/page/page_on_a_bus.hpp"

namespace curbstone::viewer {
namespace {

/// What the cards leave of the map.
class PageRoom : public PageOnABus {
 protected:
  static constexpr std::array kScreens{std::tuple{390, 844}, std::tuple{360, 640},  std::tuple{844, 390},
                                       std::tuple{667, 375}, std::tuple{820, 1180}, std::tuple{700, 900}};

  /// 36 m by 36 m.
  void put_a_square() {
    for (int x = -6; x < 6; ++x)
      for (int y = -6; y < 6; ++y) put(tile_of(x, y, semantic_tile_t::ROAD));
  }
  void show_on(int width, int height) {
    browser->resize(width, height, true);
    send_playback();
    ASSERT_TRUE(browser->comes_to("document.getElementById('timeline').checkVisibility()"));
    ASSERT_TRUE(browser->comes_to(fmt::format("curbstone.camera.width === {}", width)));
  }
  /// Between the bar and what stands at the bottom, and at the left of the tools.
  Spot middle_of_the_room() {
    const auto middle = browser->evaluate(R"((() => {
      const [bar, tools, timeline, panel] = ["bar", "tools", "timeline", "panel"].map(id => document.getElementById(id).getBoundingClientRect());
      return [tools.left / 2, (bar.bottom + Math.min(timeline.top, panel.top)) / 2];
    })())");
    return {middle[0].get<double>(), middle[1].get<double>()};
  }
};

TEST_F(PageRoom, AVehicleThatIsFollowedIsInItsMiddle) {
  put_a_square();
  open("at=0,0,40,0&follow=1&theme=light");
  for (const auto& [width, height] : kScreens) {
    show_on(width, height);
    const Spot middle = middle_of_the_room(), vehicle = spot_of(vehicle_x, 0);
    EXPECT_NEAR(vehicle.x, middle.x, 8) << width << " x " << height;
    EXPECT_NEAR(vehicle.y, middle.y, 12) << width << " x " << height;
  }
}

TEST_F(PageRoom, NoCardHidesAPartOfTheWholeMap) {
  put_a_square();
  open("at=0,0,40,0&follow=0&theme=light");
  for (const auto& [width, height] : kScreens) {
    show_on(width, height);
    browser->evaluate("document.getElementById('whole').click()");
    // Along its edges, where most of it would go under a card first.
    const auto hidden = browser->evaluate(R"(Array.from({ length: 144 }, (_, i) => {
      const along = i % 36 - 17.5, [x, y] = [[along, -17.9], [along, 17.9], [-17.9, along], [17.9, along]][Math.floor(i / 36)];
      const found = document.elementFromPoint(...curbstone.camera.toScreen(x, y));
      return document.getElementById("map").contains(found) ? "" : `${x}, ${y}: ${found?.id}`;
    }).filter(found => found))");
    EXPECT_EQ(hidden.size(), 0U) << width << " x " << height << ": " << hidden;
    const Spot left = spot_of(-18, 0), right = spot_of(18, 0), top = spot_of(0, 18), bottom = spot_of(0, -18);
    const double room = std::min(width - 120, height - 220);
    EXPECT_GT(std::max(right.x - left.x, bottom.y - top.y), 0.8 * room) << "and it is no smaller than it must be";
    if (HasFailure()) browser->save_picture(::testing::TempDir() + fmt::format("page_room_{}.png", width));
  }
}

TEST_F(PageRoom, TheToolsOfADesktopHideNoPartOfAWideMap) {
  for (int x = -20; x < 20; ++x)
    for (int y = -4; y < 8; ++y) put(tile_of(x, y, semantic_tile_t::ROAD));
  open("at=0,0,40,0&follow=0&theme=light");
  for (const auto& [width, height] : {std::pair{1280, 800}, {1000, 700}}) {
    show_on(width, height);
    browser->evaluate("document.getElementById('whole').click()");
    const auto hidden = browser->evaluate(R"(Array.from({ length: 36 }, (_, i) => {
      const found = document.elementFromPoint(...curbstone.camera.toScreen(59.9, i - 11.5));
      return document.getElementById("map").contains(found) ? "" : `${i - 11.5}: ${found?.id}`;
    }).filter(found => found))");
    EXPECT_EQ(hidden.size(), 0U) << width << " x " << height << ": " << hidden;
    EXPECT_GT(spot_of(60, 0).x - spot_of(-60, 0).x, 0.8 * (width - 416)) << "and it is no smaller than it must be";
    if (HasFailure()) browser->save_picture(::testing::TempDir() + fmt::format("page_wide_{}.png", width));
  }
}

TEST_F(PageRoom, WhileMeasuringTheCardOfACurbIsAway) {
  put_a_square();
  send_curbs({curb_along({-4, 4}, 0, 0.1F)});
  open("at=0,0,40,0&follow=0&theme=light");
  browser->resize(1280, 800, false);
  const Spot spot = spot_of(1, 0);
  browser->click(spot.x, spot.y);
  ASSERT_TRUE(shows("#cell", "Step"));
  browser->press('m');
  ASSERT_TRUE(shows("#ruler", "Click a place"));
  EXPECT_EQ(browser->evaluate("document.getElementById('cell').checkVisibility()"), false) << "they have one place";
  browser->press('m');
  EXPECT_TRUE(shows("#cell", "Step", 3)) << "what was selected still is";
}

TEST_F(PageRoom, WhatIsMeasuredIsSeenBesideItsCard) {
  put_a_square();
  open("at=0,0,20,0&follow=0&theme=light");
  for (const auto& [width, height] : kScreens) {
    show_on(width, height);
    browser->evaluate("curbstone.camera.x = curbstone.camera.y = 0");
    browser->evaluate("document.getElementById('measure').click()");
    // Under the card that asks for two places, as soon as it is as large as what it tells of them.
    const auto low = browser->evaluate(
        "(() => { const card = document.getElementById('ruler').getBoundingClientRect(); return [card.left + 40, "
        "card.bottom + 20]; })()");
    browser->hold(low[0], low[1], 0.05);
    browser->hold(low[0].get<double>() + 60, low[1], 0.05);
    ASSERT_TRUE(shows("#ruler", "3.00 m"));
    const auto places = browser->evaluate("curbstone.ruler.places");
    ASSERT_EQ(places.size(), 2U);
    for (const auto& place : places) {
      const Spot spot = spot_of(place["x"], place["y"]);
      EXPECT_EQ(browser->evaluate(fmt::format(
                    "document.getElementById('map').contains(document.elementFromPoint({}, {}))", spot.x, spot.y)),
                true)
          << width << " x " << height;
    }
    browser->evaluate("document.querySelector('#ruler button').click()");
  }
}

}  // namespace
}  // namespace curbstone::viewer
