#include <fmt/format.h>

#include <cmath>

#include "tests/services/viewer/page/page_on_a_bus.hpp"

namespace curbstone::viewer {
namespace {

constexpr const char* kView = "at=0,0,40,0&follow=0&theme=light";

/// Fingers, keys, and what the page says of itself.
class PageHands : public PageOnABus {
 protected:
  void put_a_road() {
    vehicle_x = 8;
    for (int x = -2; x < 2; ++x)
      for (int y = -2; y < 2; ++y) put(tile_of(x, y, semantic_tile_t::ROAD));
  }
  double camera(const std::string& what) { return browser->evaluate("curbstone.camera." + what); }
};

TEST_F(PageHands, AFingerThatRestsAsksWhatIsThereWhileItStillRests) {
  put_a_road();
  browser->resize(390, 844, true);
  open(kView);
  const double x = camera("x");
  browser->hold(120, 300, 1.0);
  EXPECT_TRUE(shows("#cell", "Road"));
  EXPECT_EQ(camera("x"), x) << "it is no drag";
  browser->evaluate("document.querySelector('#cell button').click()");
  EXPECT_TRUE(browser->comes_to("document.getElementById('cell').hidden"));
  browser->hold(120, 300, 0.05);
  EXPECT_TRUE(shows("#cell", "Road")) << "a tap";
}

TEST_F(PageHands, ArrowKeysMoveTheMapAndEnterAsksWhatIsInTheMiddle) {
  put_a_road();
  open(kView);
  browser->evaluate("document.getElementById('map').focus()");
  browser->press("ArrowRight");
  EXPECT_NEAR(camera("x"), 2, 1e-6) << "80 pixels of 40 a metre";
  browser->press("ArrowUp");
  EXPECT_NEAR(camera("y"), 2, 1e-6);
  browser->press("Enter");
  ASSERT_TRUE(shows("#cell", "Road"));
  EXPECT_THAT(text_of("#cell"), ::testing::HasSubstr("2.00, 2.00 m"));
  ASSERT_TRUE(browser->comes_to("document.getElementById('timeline').checkVisibility()"));
  browser->evaluate("document.getElementById('position').focus()");
  browser->press("ArrowRight");
  EXPECT_NEAR(camera("x"), 2, 1e-6) << "the bar's arrows are its own";
}

TEST_F(PageHands, NoCardCoversAnotherOnAnyScreen) {
  put_a_road();
  open(fmt::format("{}&colour=height", kView));
  ASSERT_TRUE(browser->comes_to("document.getElementById('timeline').checkVisibility()"));
  for (const auto& [width, height] : {std::pair{1280, 800}, {1024, 768}, {834, 1112}, {390, 844}, {360, 640}}) {
    browser->resize(width, height, width < 1100);
    browser->pass(0.5);
    const auto overlaps = browser->evaluate(R"((() => {
      const boxes = ["bar", "tools", "timeline", "scale", "panel"].map(id => [id, document.getElementById(id).getBoundingClientRect()]);
      const found = [];
      for (const [a, p] of boxes) for (const [b, q] of boxes)
        if (a < b && p.left < q.right && q.left < p.right && p.top < q.bottom && q.top < p.bottom) found.push(a + " " + b);
      for (const [id, box] of boxes) if (box.left < -0.5 || box.right > innerWidth + 0.5) found.push(id + " leaves the screen");
      return found;
    })())");
    EXPECT_TRUE(overlaps.empty()) << width << " x " << height << ": " << overlaps;
  }
}

/// 4 m along y = 0; the higher side is that of larger y.
curb_lines_t curb_of(bool lowered, bool inferred, std::int32_t epoch) {
  curb_line_t line{};
  line.dropped = lowered ? 1 : 0;
  line.inferred = inferred ? 1 : 0;
  line.confidence = 0.8F;
  for (int i = 0; i <= 20; ++i) {
    line.x.push_back(-4 + 0.2F * static_cast<float>(i));
    line.y.push_back(0);
    line.z.push_back(0);
    line.height.push_back(lowered ? 0.03F : 0.12F);
    line.high_side_x.push_back(0);
    line.high_side_y.push_back(1);
  }
  line.num_points = static_cast<std::int32_t>(line.x.size());
  curb_lines_t message{};
  message.epoch = epoch;
  message.box_min[0] = message.box_min[1] = -10;
  message.box_max[0] = message.box_max[1] = 10;
  message.num_lines = 1;
  message.lines = {line};
  return message;
}

TEST_F(PageHands, AnInferredCurbSaysThatNobodySawItAndWhatHidesIt) {
  put_a_road();
  put(tile_of(-1, 0, semantic_tile_t::WALL));  // a parked vehicle
  say("CURBS", curb_of(false, true, epoch()));
  open(kView);
  ASSERT_TRUE(browser->comes_to("curbstone.world.curbs.size === 1"));
  const Spot spot = spot_of(-2, -0.05);
  browser->click(spot.x, spot.y);
  ASSERT_TRUE(shows("#cell", "Inferred curb"));
  EXPECT_THAT(text_of("#cell"), ::testing::HasSubstr("Nobody saw it"));
  EXPECT_THAT(text_of("#cell"), ::testing::HasSubstr("What stands there hides it"));
  EXPECT_THAT(text_of("#cell"), ::testing::HasSubstr("Step, inferred"));
  EXPECT_EQ(browser->evaluate("document.querySelector('#cell .step').getAttribute('stroke-dasharray')"), "1 4");
}

TEST_F(PageHands, ALoweredCurbSaysSo) {
  put_a_road();
  say("CURBS", curb_of(true, false, epoch()));
  open(kView);
  ASSERT_TRUE(browser->comes_to("curbstone.world.curbs.size === 1"));
  const Spot spot = spot_of(-2, -0.05);
  browser->click(spot.x, spot.y);
  ASSERT_TRUE(shows("#cell", "Lowered curb"));
  EXPECT_THAT(text_of("#cell"), ::testing::HasSubstr("3.0 cm"));
  EXPECT_EQ(browser->evaluate("document.querySelector('#cell .step').getAttribute('stroke-dasharray')"), "5 4");
}

}  // namespace
}  // namespace curbstone::viewer
