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
    put_roads(-2, 2);
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

TEST_F(PageHands, OnAPhoneACardLeavesInSightWhatWasAskedAbout) {
  put_a_road();
  browser->resize(390, 844, true);
  open(kView);
  const double x = camera("x");
  const Spot low = spot_of(-2, -5);
  browser->hold(low.x, low.y, 0.05);
  ASSERT_TRUE(shows("#cell", "Road"));
  const auto isSeen = [&] {
    const Spot spot = spot_of(-2, -5);
    return browser->evaluate(
        fmt::format("document.getElementById('map').contains(document.elementFromPoint({}, {}))", spot.x, spot.y));
  };
  EXPECT_EQ(isSeen(), true);
  EXPECT_EQ(camera("x"), x) << "up is enough";
  browser->evaluate("document.querySelector('#cell button').click()");
  ASSERT_TRUE(browser->comes_to("document.getElementById('cell').hidden"));
  const Spot spot = spot_of(-2, -5);
  browser->hold(spot.x, spot.y, 0.05);
  ASSERT_TRUE(shows("#cell", "Road"));
  const Spot again = spot_of(-2, -5);
  EXPECT_NEAR(again.y, spot.y, 1e-6) << "nothing moves where nothing is hidden";
}

TEST_F(PageHands, OnAPhoneTheMapTakesThePlaceOfACardWhoseMapIsGone) {
  put_a_road();
  browser->resize(390, 844, true);
  open(kView);
  const double middle = browser->evaluate("curbstone.camera.offsetY").get<double>();
  const Spot road = spot_of(0, 0);
  browser->hold(road.x, road.y, 0.05);
  ASSERT_TRUE(shows("#cell", "Road"));
  ASSERT_LT(browser->evaluate("curbstone.camera.offsetY").get<double>(), middle - 50);
  begin_epoch();
  put(tile_of(50, 50, semantic_tile_t::ROAD));
  ASSERT_TRUE(browser->comes_to("document.getElementById('cell').hidden"));
  EXPECT_TRUE(browser->comes_to(fmt::format("curbstone.camera.offsetY === {}", middle)));
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

TEST_F(PageHands, ASheetIsDrawnUpByItsHandleAndHidesNothingBehindIt) {
  put_a_road();
  browser->resize(390, 844, true);
  open(kView);
  ASSERT_TRUE(browser->comes_to("document.getElementById('timeline').checkVisibility()"));
  const char* kFocusable = "getComputedStyle(document.querySelector('#panel .scroll')).visibility";
  EXPECT_EQ(browser->evaluate(kFocusable), "hidden") << "Tab does not go where nobody sees it";
  browser->drag(195, 815, 195, 600);
  EXPECT_TRUE(browser->comes_to("document.getElementById('handle').getAttribute('aria-expanded') === 'true'"));
  EXPECT_EQ(browser->evaluate(kFocusable), "visible");
  EXPECT_EQ(
      browser->evaluate("(() => { const bar = document.getElementById('timeline').getBoundingClientRect(); return "
                        "document.getElementById('panel').contains(document.elementFromPoint((bar.left + "
                        "bar.right) / 2, (bar.top + bar.bottom) / 2)); })()"),
      true)
      << "the play bar lies under it";
  browser->press("Escape");
  EXPECT_TRUE(browser->comes_to("document.getElementById('handle').getAttribute('aria-expanded') === 'false'"));
}

TEST_F(PageHands, ALinkThatIsPastedAndTheBrowsersBackShowTheirViews) {
  put_a_road();
  open(kView);
  browser->evaluate("location.hash = 'at=1,2,80,0.5&follow=0&colour=cost&tilt=30&off=curbs&theme=dark'");
  ASSERT_TRUE(browser->comes_to("curbstone.camera.scale === 80"));
  EXPECT_EQ(camera("x"), 1);
  EXPECT_NEAR(camera("tilt"), 0.5236, 1e-3);
  EXPECT_EQ(browser->evaluate("curbstone.settings.mode"), "cost");
  EXPECT_EQ(browser->evaluate("curbstone.settings.layers.curbs"), false);
  EXPECT_EQ(browser->evaluate("document.documentElement.dataset.theme"), "dark");
  browser->evaluate("history.back()");
  ASSERT_TRUE(browser->comes_to("curbstone.camera.scale === 40"));
  EXPECT_EQ(camera("tilt"), 0);
  EXPECT_EQ(browser->evaluate("curbstone.settings.mode"), "class");
  EXPECT_EQ(browser->evaluate("curbstone.settings.layers.curbs"), true);
}

/// WCAG AA: 4.5 for words, whatever the theme.
TEST_F(PageHands, WordsStandOutFromWhatTheyStandOn) {
  put_a_road();
  open(kView);
  ASSERT_TRUE(shows("#status", "Live"));
  for (const char* theme : {"light", "dark"}) {
    browser->evaluate(fmt::format("location.hash = 'at=0,0,40,0&follow=0&theme={}'", theme));
    ASSERT_TRUE(browser->comes_to(fmt::format("document.documentElement.dataset.theme === '{}'", theme)));
    browser->pass(0.5);
    const std::string faint = browser->evaluate(R"JS((() => {
      const channels = text => text.match(/[\d.]+/g).map(Number);
      const light = colour => colour.slice(0, 3).map(v => v / 255)
        .map(v => v < 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)
        .reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);
      const under = element => {
        for (; element; element = element.parentElement) {
          const colour = channels(getComputedStyle(element).backgroundColor);
          if (colour.length < 4 || colour[3] > 0.9) return colour;
        }
        return [255, 255, 255];
      };
      return [...document.querySelectorAll("body *")].filter(element => {
        const says = [...element.childNodes].some(node => node.nodeType === 3 && node.data.trim());
        if (!says || !element.offsetParent || element.disabled) return false;
        const [a, b] = [light(channels(getComputedStyle(element).color)), light(under(element))];
        return (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05) < 4.5;
      }).map(element => element.textContent).join("; ");
    })())JS");
    EXPECT_EQ(faint, "") << theme;
  }
}

TEST_F(PageHands, ALinkThatSomebodyMarredShowsSomething) {
  put_a_road();
  open("at=0,0,1e-9,0&follow=0&colour=sepia&theme=pink&tilt=400&off=all");
  EXPECT_NEAR(camera("scale"), 0.02, 1e-9);
  EXPECT_LT(camera("tilt"), 1.2);
  EXPECT_EQ(browser->evaluate("curbstone.settings.mode"), "class");
  browser->evaluate("location.hash = 'at=0,0,1e9,0&follow=0'");
  EXPECT_TRUE(browser->comes_to("curbstone.camera.scale === 800"));
}

TEST_F(PageHands, EachControlHasANameAndGroupsOfChoicesGoByArrows) {
  put_a_road();
  open(kView);
  const auto nameless = browser->evaluate(
      "[...document.querySelectorAll('button, input')].filter(e => !(e.ariaLabel || e.innerText.trim() || e.title || "
      "e.labels?.length)).map(e => e.outerHTML)");
  EXPECT_TRUE(nameless.empty()) << nameless;
  browser->evaluate("document.querySelector('#colours [aria-checked=true]').focus()");
  browser->press("ArrowRight");
  EXPECT_EQ(browser->evaluate("curbstone.settings.mode"), "height");
  EXPECT_EQ(browser->evaluate("document.activeElement.innerText"), "Height");
  EXPECT_EQ(browser->evaluate("document.querySelectorAll('#colours [tabindex=\"0\"]').length"), 1);
  EXPECT_EQ(camera("x"), 0) << "the map stays";
}

TEST_F(PageHands, KeysAreTheSameWithCapsLockAndAHeldOneSwitchesOnce) {
  put_a_road();
  open(kView);
  browser->press('M');
  EXPECT_TRUE(browser->comes_to("curbstone.ruler.isOn", 2));
  browser->evaluate("dispatchEvent(new KeyboardEvent('keydown', { key: 'm', repeat: true }))");
  EXPECT_EQ(browser->evaluate("curbstone.ruler.isOn"), true);
}

TEST_F(PageHands, AfterAClickTheKeyboardIsTheMaps) {
  put_a_road();
  open(kView);
  ASSERT_TRUE(browser->comes_to("document.getElementById('timeline').checkVisibility()"));
  const auto click = [&](const std::string& selector) {
    const auto place =
        browser->evaluate("(() => { const b = document.querySelector('" + selector +
                          "').getBoundingClientRect(); return [(b.left + b.right) / 2, (b.top + b.bottom) / 2]; })()");
    browser->click(place[0], place[1]);
    browser->pass(0.1);
  };
  click("#layers [data-layer=path]");
  ASSERT_EQ(browser->evaluate("curbstone.settings.layers.path"), false);
  browser->press(' ');
  EXPECT_EQ(browser->evaluate("curbstone.settings.layers.path"), false) << "Space is not for what was clicked";
  EXPECT_TRUE(browser->comes_to("curbstone.rewind.isPast", 3)) << "but pauses";
  click("#colours [data-title=Cost]");
  browser->press("ArrowRight");
  EXPECT_EQ(browser->evaluate("curbstone.settings.mode"), "cost");
  EXPECT_NEAR(camera("x"), 2, 1e-6);
  // Without the mouse what is focused has its keys.
  browser->evaluate("document.querySelector('#layers [data-layer=path] input').focus()");
  browser->evaluate("curbstone.rewind.goLive()");
  browser->press(' ');
  EXPECT_TRUE(browser->comes_to("curbstone.settings.layers.path", 3));
  EXPECT_EQ(browser->evaluate("curbstone.rewind.isPast"), false);
}

TEST_F(PageHands, ACardIsClosedByTheMouseWhileNewsCome) {
  put_a_road();
  speed = 1;  // the card's ages and distances are other with each frame
  open(kView);
  // After two seconds the bar of the past comes, and lifts the card.
  ASSERT_TRUE(browser->comes_to("document.getElementById('timeline').checkVisibility()"));
  const Spot spot = spot_of(-2, -2);
  browser->click(spot.x, spot.y);
  ASSERT_TRUE(shows("#cell", "Road"));
  browser->evaluate("window.close_button = document.querySelector('#cell button')");
  browser->pass(0.5);
  EXPECT_EQ(browser->evaluate("close_button.isConnected"), true) << "a press and its release meet the same button";
  const auto place = browser->evaluate(
      "(() => { const b = close_button.getBoundingClientRect(); return [(b.left + b.right) / 2, (b.top + b.bottom) / "
      "2]; })()");
  browser->click(place[0], place[1]);
  EXPECT_TRUE(browser->comes_to("document.getElementById('cell').hidden"));
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
  send("CURBS", curb_of(false, true, epoch()));
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
  send("CURBS", curb_of(true, false, epoch()));
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
