#include <fmt/format.h>

#include "tests/services/viewer/cloud_messages.hpp"
#include "tests/services/viewer/page/page_on_a_bus.hpp"

namespace curbstone::viewer {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kCloudView = "at=0,0,40,0&follow=0&theme=light&off=relief.curbs.path.points";

/// A road with the dense cloud over the tile (-1, -1): a patch of points 0.1 m apart, all at one height.
class PageCloud : public PageOnABus {
 protected:
  void SetUp() override {
    PageOnABus::SetUp();
    if (IsSkipped()) return;
    vehicle_x = 10;
    put_roads(-2, 2);
  }
  static constexpr int kPatchAside = 20;  // points
  static constexpr int kApart = 50;       // steps of 2 mm
  static constexpr int kCorner = 25;      // the first one's x and y

  /// Over a road, with the cloud as it is chosen in the page's address; `z` in steps.
  void show_patch(const std::string& view, std::int16_t z, std::uint8_t intensity) {
    open(view);
    browser->pass(0.5);  // until the viewer has heard what the page wants
    send("MAP_POINTS", patch(z, intensity));
    ASSERT_TRUE(has(kPatchAside * kPatchAside));
  }
  map_points_t patch(std::int16_t z, std::uint8_t intensity) const {
    map_points_t message{};
    message.epoch = epoch();
    message.tile_x = message.tile_y = -1;
    message.num_points = kPatchAside * kPatchAside;
    for (int i = 0; i < kPatchAside * kPatchAside; ++i) {
      message.x.push_back(static_cast<std::int16_t>(kCorner + i % kPatchAside * kApart));
      message.y.push_back(static_cast<std::int16_t>(kCorner + i / kPatchAside * kApart));
      message.z.push_back(z);
      message.intensity.push_back(intensity);
    }
    return message;
  }
  voted_points_t saliency(std::uint8_t stick, std::uint8_t plate) const {
    const map_points_t points = patch(0, 64);
    voted_points_t message = voted({-1, -1}, 0, points.num_points, 0, 1, stick, plate);
    message.epoch = epoch();
    message.z_origin = 0;
    message.x = points.x;
    message.y = points.y;
    message.z = points.z;
    message.intensity = points.intensity;
    return message;
  }
  void want(const std::string& colour) {
    browser->evaluate(fmt::format(
        "[...document.querySelectorAll('#cloud-colours button')].find(b => b.dataset.title === '{}').click()", colour));
  }
  bool has(int points, double seconds = 30) {
    return browser->comes_to(fmt::format("curbstone.world.cloud.points === {}", points), seconds);
  }
  /// The colour at a point of the patch, above the ground by z, m.
  Rgb at_point(int column, int row, double z = 0) {
    browser->pass(0.3);
    const auto spot =
        browser->evaluate(fmt::format("curbstone.camera.toScreen({}, {}, {})", -3 + 0.002 * (kCorner + column * kApart),
                                      -3 + 0.002 * (kCorner + row * kApart), z));
    return browser->picture().at(spot[0].get<double>(), spot[1].get<double>());
  }
  static bool is_like(const Rgb& seen, const Rgb& expected) { return difference(seen, expected) < 12; }
};

constexpr std::array<int, 3> kCloudHigh = {253, 231, 37}, kCloudLow = {68, 1, 84};  // page/drawing/palette.ts

TEST_F(PageCloud, IsOffUntilItIsAskedForAndIsEmptiedWhenItIsOff) {
  open(kCloudView);
  send("MAP_POINTS", patch(1200, 64));
  browser->pass(0.5);
  EXPECT_EQ(browser->evaluate("curbstone.world.cloud.points"), 0);
  EXPECT_TRUE(is_like(at_point(5, 5), colour_of(semantic_tile_t::ROAD)));
  EXPECT_EQ(browser->evaluate("document.getElementById('cloud').hidden"), true);

  browser->press('c');
  EXPECT_TRUE(shows("#cloud", "Dense cloud"));
  EXPECT_TRUE(browser->comes_to("location.hash.includes('cloud=height')"));
  browser->pass(0.3);  // until the viewer has heard it
  send("MAP_POINTS", patch(1200, 64));
  ASSERT_TRUE(has(kPatchAside * kPatchAside));
  EXPECT_TRUE(is_like(at_point(5, 5), kCloudHigh)) << "2.4 m up";
  EXPECT_TRUE(is_like(at_point(19, 19), kCloudHigh));
  EXPECT_TRUE(is_like(at_point(24, 5), colour_of(semantic_tile_t::ROAD))) << "beside it";
  if (HasFailure()) browser->save_picture(::testing::TempDir() + "page_cloud.png");

  browser->press('c');
  EXPECT_TRUE(has(0));
  EXPECT_TRUE(is_like(at_point(5, 5), colour_of(semantic_tile_t::ROAD)));
  send("MAP_POINTS", patch(1200, 64));
  browser->pass(0.5);
  EXPECT_EQ(browser->evaluate("curbstone.world.cloud.points"), 0);
}

TEST_F(PageCloud, IsColouredByWhatIsChosen) {
  show_patch(fmt::format("{}&cloud=height", kCloudView), -500, 255);
  EXPECT_TRUE(is_like(at_point(5, 5), kCloudLow)) << "a metre below the ground";
  want("Intensity");
  EXPECT_TRUE(is_like(at_point(5, 5), {255, 234, 70})) << "as bright as it gets";

  want("Surface");
  browser->pass(0.5);
  send("MAP_POINTS", patch(0, 255));
  EXPECT_TRUE(browser->comes_to("curbstone.world.cloud.points === 400"));
  EXPECT_TRUE(is_like(at_point(5, 5), {176, 182, 190})) << "its saliency is not known yet";
  send("VOTED_POINTS", saliency(127, 0));
  EXPECT_TRUE(browser->comes_to("curbstone.world.cloud.tiles.get('-1,-1').bytes[7] === 127"));
  EXPECT_TRUE(is_like(at_point(5, 5), {8, 56, 96})) << "a surface";
  want("Line");
  EXPECT_TRUE(is_like(at_point(5, 5), {214, 222, 228})) << "no edge";
  EXPECT_TRUE(browser->comes_to("location.hash.includes('cloud=line')"));
  if (HasFailure()) browser->save_picture(::testing::TempDir() + "page_cloud.png");
}

TEST_F(PageCloud, StandsAtItsHeightInTheTiltedView) {
  show_patch(fmt::format("{}&cloud=height&tilt=50", kCloudView), 1000, 64);
  browser->pass(0.5);
  EXPECT_TRUE(is_like(at_point(5, 5, 2), kCloudHigh));
  EXPECT_TRUE(is_like(at_point(19, 19, 2), kCloudHigh));
  EXPECT_FALSE(is_like(at_point(5, 0, 0), kCloudHigh)) << "nothing is on the ground there";
  if (HasFailure()) browser->save_picture(::testing::TempDir() + "page_cloud.png");
}

TEST_F(PageCloud, ACrossSectionBringsAndShowsThePointsAcrossTheCurb) {
  send_curbs({curb_along({-3, -2, -1, 0}, -2, 0.1F)});
  open("at=0,0,40,0&follow=0&theme=light");
  ASSERT_TRUE(browser->comes_to("curbstone.world.curbs.size === 1"));
  const Spot spot = spot_of(-2.05, -2);
  browser->click(spot.x, spot.y);
  ASSERT_TRUE(shows("#cell", "Cells across it"));
  browser->pass(0.5);
  send("MAP_POINTS", patch(50, 64));  // 10 cm up
  ASSERT_TRUE(has(kPatchAside * kPatchAside)) << "though the cloud is off";
  ASSERT_TRUE(shows("#cell", "Cells and points"));
  const auto points = browser->evaluate(
      "[...document.querySelectorAll('#cell rect')].map(r => [+r.getAttribute('x') + 1, +r.getAttribute('y') + 1])");
  EXPECT_EQ(points.size(), 60U) << "three columns of the patch lie within 0.15 m of the normal";
  for (const auto& point : points) {
    EXPECT_NEAR(point[1].get<double>(), (0.45 - 0.1) / 0.6 * 96, 0.01);
    EXPECT_GT(point[0].get<double>(), 116 - 1.0 / 1.5 * 116);
    EXPECT_LT(point[0].get<double>(), 116 + 1.0 / 1.5 * 116);
  }
  EXPECT_TRUE(is_like(at_point(15, 15), colour_of(semantic_tile_t::ROAD))) << "the map does not show them";
  browser->evaluate("document.querySelector('#cell button').click()");
  EXPECT_TRUE(has(0));
  if (HasFailure()) browser->save_picture(::testing::TempDir() + "page_cloud.png");
}

TEST_F(PageCloud, ThePastHasNoneAndSaysSo) {
  speed = 1;
  show_patch("at=0,0,20,0&follow=0&theme=light&cloud=height", 0, 64);
  ASSERT_TRUE(browser->comes_to("curbstone.rewind.playback()"));
  browser->pass(1);
  browser->press(' ');
  EXPECT_TRUE(browser->comes_to("curbstone.rewind.isPast"));
  EXPECT_TRUE(shows("#cloud", "has no dense cloud"));
  EXPECT_TRUE(shows("#curtain", "The dense cloud is not shown")) << "where the panel is folded, too";
  EXPECT_EQ(browser->evaluate("curbstone.world.cloud.points"), 0);
  map_points_t more = patch(0, 64);
  more.tile_x = 0;
  send("MAP_POINTS", more);
  EXPECT_TRUE(browser->comes_to("curbstone.rewind.live.cloud.points === 800")) << "it goes on coming";
  browser->press('l');
  EXPECT_TRUE(has(2 * kPatchAside * kPatchAside));
  EXPECT_THAT(text_of("#cloud"), Not(HasSubstr("has no dense cloud")));
  EXPECT_TRUE(browser->comes_to("document.getElementById('curtain').hidden"));
}

/// Whoever sees no hues still sees which is more: from end to end each ramp only becomes lighter, or only darker.
TEST_F(PageCloud, HasRampsThatGoByLightnessAlone) {
  for (const char* theme : {"light", "dark"}) {
    for (const char* by : {"height", "intensity", "surface", "line"}) {
      open(fmt::format("at=0,0,20,0&follow=0&theme={}&cloud={}", theme, by));
      const auto lights = browser->evaluate(
          "getComputedStyle(document.querySelector('#cloud-legend .ramp')).backgroundImage.match(/rgb\\([^)]*\\)/g)"
          ".map(c => c.match(/\\d+/g).map(Number)).map(([r, g, b]) => 0.2126 * r + 0.7152 * g + 0.0722 * b)");
      ASSERT_EQ(lights.size(), 8U) << theme << " " << by;
      const bool rises = lights[7].get<double>() > lights[0].get<double>();
      for (std::size_t i = 1; i < 8; ++i)
        EXPECT_GT((lights[i].get<double>() - lights[i - 1].get<double>()) * (rises ? 1 : -1), 2)
            << theme << " " << by << " " << i;
    }
  }
}

TEST_F(PageCloud, KeepsNoMorePointsThanItMay) {
  open(kCloudView);
  // Tiles of 1,000 points each, from the far away to the view at (0, 0); the vehicle is at 300 m.
  const auto left = browser->evaluate(R"((() => {
    const cloud = new curbstone.world.cloud.constructor(50_000);
    for (let x = 200; x >= 0; --x) cloud.resize(x, 0, 0, 1000);
    cloud.trim(0, 0, { x: 300, y: 0 });
    return [cloud.points, cloud.tiles.has("0,0"), cloud.tiles.has("100,0"), cloud.tiles.has("60,0"), cloud.tiles.has("200,0")];
  })())");
  EXPECT_LE(left[0].get<int>(), 50'000);
  EXPECT_GE(left[0].get<int>(), 44'000);
  EXPECT_EQ(left[1], true);
  EXPECT_EQ(left[2], true) << "the viewer would not send it again";
  EXPECT_EQ(left[3], false);
  EXPECT_EQ(left[4], false);
}

}  // namespace
}  // namespace curbstone::viewer
