// A phone and a tablet upright: each gesture with real touches, targets for fingers, nothing on something else.
#include <fmt/format.h>

#include "tests/services/viewer/page/page_on_a_bus.hpp"

namespace curbstone::viewer {
namespace {

struct Screen {
  const char* name;
  int width;
  int height;
};

class PageTouch : public PageOnABus, public ::testing::WithParamInterface<Screen> {
 protected:
  void show(const std::string& view) {
    vehicle_x = 2;
    put_roads(-3, 3);
    browser->resize(GetParam().width, GetParam().height, true);
    open(view);
    ASSERT_TRUE(shows("#status", "Live"));
    ASSERT_TRUE(browser->comes_to("document.getElementById('timeline').checkVisibility()"));
  }
  void keep_picture(const std::string& name) { PageOnABus::keep_picture(fmt::format("{}_{}", GetParam().name, name)); }
  void swipe(const Spot& from, const Spot& to) { browser->swipe({from.x, from.y, to.x, to.y}); }
  double camera(const std::string& what) { return browser->evaluate("curbstone.camera." + what); }
  /// What a finger can hit: smaller than 40 pixels either way, or what lies on another such thing.
  std::string small_targets() {
    return browser->evaluate(R"JS((() => {
      const sees = element => element.checkVisibility({ checkVisibilityCSS: true }) && !element.disabled;
      const target = element => element.type === "checkbox" ? element.closest("label") : element;
      return [...document.querySelectorAll("button, input, summary")].filter(sees).map(target)
        .map(element => [element, element.getBoundingClientRect()])
        .filter(([, { width, height }]) => width < 40 || height < 40)
        .map(([element, { width, height }]) => `${element.id || element.textContent}: ${width.toFixed(0)} x ${height.toFixed(0)}`).join("; ");
    })())JS");
  }
  /// Cards that lie on each other or reach beyond the window, and words that are cut.
  std::string misplaced() {
    return browser->evaluate(R"JS((() => {
      const cards = ["#bar", "#tools", "#timeline", "#scale", "#cell", "#ruler", "#curtain", "#handle"].map(name => document.querySelector(name))
        .filter(card => card.checkVisibility({ checkVisibilityCSS: true })).map(card => [card.id, card.getBoundingClientRect()]).filter(([, { width }]) => width > 0);
      const wrong = [], figures = document.querySelector("#summary span"), shown = figures.textContent;
      if (!figures.className) figures.textContent = "88.8 m/s · 888 ms delay";  // the widest: the test's own are chance
      cards.forEach(([name, a], i) => {
        if (a.left < 0 || a.top < 0 || a.right > innerWidth + 0.5 || a.bottom > innerHeight + 0.5) wrong.push(`${name} is beyond the window`);
        for (const [other, b] of cards.slice(i + 1))
          if (a.left < b.right - 0.5 && b.left < a.right - 0.5 && a.top < b.bottom - 0.5 && b.top < a.bottom - 0.5) wrong.push(`${name} on ${other}`);
      });
      for (const element of document.querySelectorAll("button, .chip, dt, dd, #elapsed, #summary span"))
        if (element.checkVisibility({ checkVisibilityCSS: true }) && element.scrollWidth > element.clientWidth + 1 && getComputedStyle(element).display !== "inline")
          wrong.push(`cut: ${element.textContent}`);
      figures.textContent = shown;
      return wrong.join("; ");
    })())JS");
  }
};

TEST_P(PageTouch, AFingerMovesTheMapAndTwoZoomIt) {
  show("at=0,0,40,0&follow=1&theme=light");
  ASSERT_EQ(browser->evaluate("curbstone.settings.follow"), true);
  swipe({120, 300}, {200, 300});
  EXPECT_EQ(browser->evaluate("curbstone.settings.follow"), false) << "the map was taken in hand";
  const double x = camera("x");
  const double y = camera("y");
  swipe({120, 300}, {200, 380});
  EXPECT_NEAR(camera("x"), x - 80 / 40.0, 0.05);
  EXPECT_NEAR(camera("y"), y + 80 / 40.0, 0.05);
  EXPECT_EQ(browser->evaluate("document.getElementById('cell').hidden"), true) << "no tap";
  browser->touch({150, 300, 100, 300}, {200, 300, 250, 300});
  EXPECT_NEAR(camera("scale"), 40 * 150 / 70.0, 2)
      << "three times as wide apart, less the step that decides the gesture";
  EXPECT_EQ(camera("tilt"), 0);
}

TEST_P(PageTouch, ALongPressAsksAndNothingLiesOnTheAnswer) {
  for (const char* theme : {"light", "dark"}) {
    if (tiles.empty()) {
      show(fmt::format("at=0,0,40,0&follow=0&theme={}", theme));
    } else {
      browser->evaluate(fmt::format("location.hash = 'at=0,0,40,0&follow=0&theme={}'", theme));
    }
    keep_picture(fmt::format("map_{}", theme));
    EXPECT_EQ(misplaced(), "") << theme;
    EXPECT_EQ(small_targets(), "") << theme;
    browser->hold(120, 300, 0.9);
    ASSERT_TRUE(shows("#cell", "Road"));
    keep_picture(fmt::format("cell_{}", theme));
    EXPECT_EQ(misplaced(), "") << theme;
    EXPECT_EQ(small_targets(), "") << theme;
    browser->evaluate("document.querySelector('#cell button').click()");
    ASSERT_TRUE(browser->comes_to("document.getElementById('cell').hidden"));
    browser->evaluate("document.getElementById('handle').click()");
    browser->pass(0.6);
    keep_picture(fmt::format("sheet_{}", theme));
    EXPECT_EQ(small_targets(), "") << theme;
    browser->evaluate("document.getElementById('handle').click()");
    browser->pass(0.6);
  }
}

TEST_P(PageTouch, ADeadBusIsGreyInTwoSeconds) {
  show("at=0,0,40,0&follow=0&theme=light&off=relief.curbs.path.points");
  put(tile_of(-1, -1, semantic_tile_t::WALL));
  browser->pass(0.5);
  const auto is_coloured = [&] {
    const Spot spot = spot_of(-1.3, -1.3);
    const Rgb colour = browser->picture().at(spot.x, spot.y);
    return difference(colour, {colour[0], colour[0], colour[0]}) > 20;
  };
  ASSERT_TRUE(is_coloured());
  // Counted by the page itself, from the last message to the word, and to the pixel: the map's own canvas is read in
  // the task after each drawing.
  browser->evaluate(R"JS((() => {
    const status = document.getElementById("status"), gl = document.getElementById("ground").getContext("webgl2");
    const draw = gl.drawArrays.bind(gl), [x, y] = curbstone.camera.toScreen(-1.3, -1.3).map(at => at * devicePixelRatio);
    const pixel = new Uint8Array(4);
    let last = 0;
    const note = () => {
      const { state } = curbstone.world, now = performance.now();
      if (state.bus_age < 0.15) last = now - 1000 * state.bus_age;
      if (status.textContent === "Silent") window.word ??= now - last;
      if (gl.getParameter(gl.FRAMEBUFFER_BINDING)) return;  // the picture of a page is being painted
      gl.readPixels(x, gl.drawingBufferHeight - 1 - y, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
      if (pixel[3] > 0 && Math.max(...pixel.slice(0, 3)) - Math.min(...pixel.slice(0, 3)) < 8) window.grey ??= now - last;
    };
    gl.drawArrays = (...what) => { draw(...what); note(); };
    new MutationObserver(note).observe(status, { childList: true, characterData: true, subtree: true });
    return 0;
  })())JS");
  browser->pass(0.5);
  ASSERT_TRUE(browser->evaluate("!window.word && !window.grey"));
  bus_is_alive = false;
  ASSERT_TRUE(shows("#status", "Silent"));
  ASSERT_TRUE(browser->comes_to("window.grey > 0"));
  EXPECT_LE(browser->evaluate("word").get<double>(), 2000) << "ms";
  EXPECT_LE(browser->evaluate("grey").get<double>(), 2000) << "ms";
  EXPECT_GT(browser->evaluate("word").get<double>(), 1000) << "the measurement itself: no pause of a second is a death";
  browser->pass(0.3);
  EXPECT_FALSE(is_coloured());
  EXPECT_EQ(misplaced(), "");
  keep_picture("silent");
}

TEST_P(PageTouch, AFingerGoesBackInTime) {
  speed = 1;
  show("at=0,0,40,0&follow=0&theme=light");
  browser->pass(3);
  const auto bar = browser->evaluate(
      "(() => { const { left, right, top, bottom } = document.getElementById('position').getBoundingClientRect(); "
      "return [left, right, (top + bottom) / 2]; })()");
  const double left = bar[0], right = bar[1], y = bar[2];
  swipe({right - 8, y}, {(left + right) / 2, y});
  EXPECT_EQ(browser->evaluate("curbstone.rewind.isPast"), true);
  EXPECT_TRUE(shows("#status", "ago"));
  EXPECT_EQ(misplaced(), "");
  keep_picture("past");
  browser->evaluate("document.getElementById('live').click()");
  EXPECT_TRUE(shows("#status", "Live"));
}

INSTANTIATE_TEST_SUITE_P(Screens, PageTouch, ::testing::Values(Screen{"phone", 390, 844}, Screen{"tablet", 820, 1180}),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace curbstone::viewer
