// Whether everything can be seen, by whoever looks, on whatever screen.
#include "common/time/clock.hpp"
#include "tests/services/viewer/page/page_on_a_bus.hpp"

namespace curbstone::viewer {
namespace {

class PageSight : public PageOnABus {
 protected:
  /// Whether two elements that are there lie on each other.
  bool overlap(const std::string& one, const std::string& other) {
    return browser->evaluate("(() => { const [a, b] = ['" + one + "', '" + other +
                             "'].map(name => document.querySelector(name).getBoundingClientRect()); "
                             "return a.width > 0 && b.width > 0 && a.left < b.right && b.left < a.right && "
                             "a.top < b.bottom && b.top < a.bottom; })()");
  }
  std::string style_of(const std::string& selector, const std::string& property) {
    return browser->evaluate("getComputedStyle(document.querySelector('" + selector + "'))['" + property + "']");
  }
};

TEST_F(PageSight, ForcedColoursLeaveTheLegendAndWhatIsOn) {
  put_roads(-1, 2);
  browser->prefer({{"forced-colors", "active"}, {"prefers-color-scheme", "dark"}});
  open("");
  EXPECT_EQ(style_of("#legend .keys i", "background-color"), "rgb(70, 78, 89)") << "the road's key, as on the map";
  EXPECT_NE(style_of("#layers input", "appearance"), "none") << "the system draws what is on";
  EXPECT_NE(style_of("#colours [aria-checked=true]", "background-color"),
            style_of("#colours [aria-checked=false]", "background-color"));
  EXPECT_NE(style_of("#panel", "border-top-style"), "none");
}

TEST_F(PageSight, AnEllipseLargerThanTheViewTintsNoMap) {
  put_roads(-1, 2);
  bus_is_alive = false;
  open("at=0,0,40,0&follow=0&theme=light&off=relief.curbs.path.points");
  map_pose_t pose{};
  pose.utime = wall_clock();
  pose.epoch = epoch();
  pose.map_base_position[0] = 200;
  pose.map_base_orientation[0] = pose.map_odom_orientation[0] = 1;
  pose.covariance[0] = pose.covariance[7] = 1e5F;
  pose.flags = map_pose_t::LOST;
  for (int i = 0; i < 20; ++i) {
    pose.utime += 50'000;
    send("MAP_POSE", pose);
    browser->pass(0.05);
  }
  ASSERT_EQ(browser->evaluate("curbstone.world.state.pose.lost"), true);
  const Spot spot = spot_of(-1.3, -1.3);
  EXPECT_LE(difference(browser->picture().at(spot.x, spot.y), colour_of(semantic_tile_t::ROAD)), 6);
}

TEST_F(PageSight, ASentenceLiesOnNoCard) {
  put_roads(-1, 2);
  struct Screen {
    int width, height;
    bool touch;
  };
  for (const Screen& screen : {Screen{1280, 800, false}, {1000, 700, false}, {390, 844, true}, {320, 568, true}}) {
    browser->resize(screen.width, screen.height, screen.touch);
    bus_is_alive = true;
    open("theme=light");
    ASSERT_TRUE(shows("#status", "Live"));
    browser->press('m');
    bus_is_alive = false;
    ASSERT_TRUE(shows("#curtain", "this is how it was"));
    EXPECT_FALSE(overlap("#curtain", "#ruler")) << screen.width;
    EXPECT_FALSE(overlap("#curtain", "#follow")) << screen.width;
    EXPECT_FALSE(overlap("#ruler", "#tools")) << screen.width;
  }
}

TEST_F(PageSight, TheMapShowsThatTheKeyboardMovesIt) {
  put_roads(-1, 2);
  open("theme=light&panel=0");
  const auto frame = [&] { return browser->picture().at(4, 400); };  // at the left edge
  const Rgb before = frame();
  browser->evaluate("document.getElementById('map').focus({ focusVisible: true })");
  browser->press("ArrowLeft");
  browser->pass(0.2);
  EXPECT_GT(difference(frame(), before), 60);
  EXPECT_GT(difference(frame(), {214, 36, 127}), 60) << "the accent frames the past";
}

TEST_F(PageSight, WhatStandsStillIsNotDrawnAgain) {
  put_roads(-1, 2);
  open("theme=light");
  send_playback(true);
  bus_is_alive = false;
  ASSERT_TRUE(shows("#status", "Paused"));
  browser->pass(1.5);
  browser->evaluate(R"((() => {
    const gl = document.getElementById("ground").getContext("webgl2"), clear = gl.clear.bind(gl);
    [window.draws, window.before] = [0, curbstone.world.state];
    gl.clear = mask => { ++draws; clear(mask); };
  })())");
  browser->pass(2);
  EXPECT_EQ(browser->evaluate("curbstone.world.state !== before"), true) << "frames come";
  EXPECT_LE(browser->evaluate("draws").get<int>(), 1);
  bus_is_alive = true;
  EXPECT_TRUE(browser->comes_to("draws > 3", 10)) << "each pose is a picture";
}

TEST_F(PageSight, AHeadingIsNeverFullCircle) {
  put_roads(-1, 2);
  bus_is_alive = false;
  open("theme=light");
  map_pose_t pose{};
  pose.utime = wall_clock();
  pose.epoch = epoch();
  pose.map_base_orientation[0] = pose.map_odom_orientation[0] = 1;
  pose.map_base_orientation[3] = -0.0003;  // 0.03 degrees to the right
  pose.flags = map_pose_t::REGISTERED;
  for (int i = 0; i < 4; ++i) {
    pose.utime += 50'000;
    send("MAP_POSE", pose);
  }
  ASSERT_TRUE(browser->comes_to("curbstone.world.state.pose.yaw < 0"));
  EXPECT_TRUE(shows("#facts", "0.0°")) << text_of("#facts");
  EXPECT_THAT(text_of("#facts"), ::testing::Not(::testing::HasSubstr("360.0")));
}

}  // namespace
}  // namespace curbstone::viewer
