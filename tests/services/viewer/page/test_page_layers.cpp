// Each layer by a pixel whose colour is known; CURBSTONE_TEST_PICTURES keeps a picture of each, to be looked at.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/services/viewer/page/page_on_a_bus.hpp"

namespace curbstone::viewer {
namespace {

class PageLayers : public PageOnABus {
 protected:
  struct Values {
    std::uint8_t cost = 0;
    std::uint8_t confidence = 0;
    double height = 1;          // m
    std::int64_t older_by = 0;  // us
  };
  /// Of road.
  void put_tile(int x, int y, const Values& values) {
    semantic_tile_t tile = tile_of(x, y, semantic_tile_t::ROAD);
    tile.utime -= values.older_by;
    std::fill(std::begin(tile.cost), std::end(tile.cost), values.cost);
    std::fill(std::begin(tile.confidence), std::end(tile.confidence), values.confidence);
    std::fill(std::begin(tile.height), std::end(tile.height),
              static_cast<std::int16_t>(std::lround(values.height / 0.002)));
    put(tile);
  }
  Rgb at(double x, double y) {
    const Spot spot = spot_of(x, y);
    return browser->picture().at(spot.x, spot.y);
  }
  bool is_road(double x, double y) { return difference(at(x, y), colour_of(semantic_tile_t::ROAD)) <= 4; }
  /// The middles of two tiles, in one look of the page.
  void expect_colours(const std::string& mode, const Rgb& left, const Rgb& right) {
    vehicle_x = 60;
    open("at=0,0,40,0&follow=0&theme=light&off=relief.curbs.path.points&colour=" + mode);
    browser->pass(1.2);  // the ends of the heights' ramp
    EXPECT_LE(difference(at(-1.5, -1.5), left), 6) << mode << ": " << ::testing::PrintToString(at(-1.5, -1.5));
    EXPECT_LE(difference(at(1.5, -1.5), right), 6) << mode << ": " << ::testing::PrintToString(at(1.5, -1.5));
    keep_picture("layer_" + mode);
  }
  void click_layer(const std::string& name) {
    browser->evaluate(
        fmt::format("[...document.querySelectorAll('#layers label')].find(l => l.innerText === '{}').click()", name));
    browser->pass(0.3);
  }
};

// Colours as in page/drawing/palette.ts: the ends of the ramps, and between them.

TEST_F(PageLayers, HeightsHaveTheColoursOfTheirRamp) {
  put_tile(-1, -1, {.height = 1});
  put_tile(0, -1, {.height = 2});
  expect_colours("height", {68, 1, 84}, {253, 231, 37});
}

TEST_F(PageLayers, CostsHaveTheColoursOfTheirRamp) {
  put_tile(-1, -1, {.cost = 127});
  put_tile(0, -1, {.cost = 254});
  expect_colours("cost", {236, 140, 46}, {96, 20, 18});
}

TEST_F(PageLayers, ConfidencesHaveTheColoursOfTheirRamp) {
  put_tile(-1, -1, {.confidence = 0});
  put_tile(0, -1, {.confidence = 255});
  expect_colours("confidence", {222, 228, 232}, {8, 56, 96});
}

TEST_F(PageLayers, AgesHaveTheColoursOfARampByTheirLogarithm) {
  put_tile(-1, -1, {.older_by = -300'000'000});  // newer than any pose of this test
  put_tile(0, -1, {.older_by = 700'000'000});
  expect_colours("age", {255, 214, 102}, {66, 58, 108});
  // The ramp goes by the logarithm: the age in its middle is not the half of that at its end.
  const auto middle = browser->evaluate(R"((() => {
    const bar = document.querySelector("#legend .ramp").getBoundingClientRect();
    const spans = [...document.querySelectorAll("#legend .ends span")].filter(span => {
      const range = document.createRange();
      range.selectNodeContents(span);
      const box = range.getBoundingClientRect();
      return Math.abs((box.left + box.right) / 2 - (bar.left + bar.right) / 2) < 3;
    });
    return spans.map(span => span.innerText);
  })())");
  EXPECT_EQ(middle, nlohmann::json::array({"24 s"})) << text_of("#legend");
  const auto ages = browser->evaluate("[0, 0.25, 0.5, 0.75, 1].map(share => Math.round(601 ** share - 1))");
  EXPECT_EQ(ages, nlohmann::json::array({0, 4, 24, 120, 600})) << "as kPicture's shader has it";
}

TEST_F(PageLayers, CurbsThatWereSeenLoweredOnesAndInferredOnes) {
  vehicle_x = 60;
  put_roads(-2, 2);
  std::vector<curb_line_t> curbs;
  for (const float y : {-2.0F, 0.0F, 2.0F}) {  // seen, lowered, inferred
    curb_line_t line = curb_along({-5, 5}, y, 0.1F);
    line.dropped = y == 0 ? 1 : 0;
    line.inferred = y > 1 ? 1 : 0;
    curbs.push_back(line);
  }
  send_curbs(curbs);
  open("at=0,0,60,0&follow=0&theme=light&off=relief.path.points");
  ASSERT_TRUE(browser->comes_to("curbstone.world.curbs.size === 3 && !curbstone.world.curbsChanged"));
  browser->pass(0.3);
  const Picture picture = browser->picture();
  /// The share of a line that is nearly as dark as a curb's ink.
  const auto ink = [&](double y) {
    const Spot from = spot_of(-4, y), to = spot_of(4, y);
    int dark = 0, all = 0;
    for (double x = from.x; x < to.x; ++x, ++all) {
      int nearest = 1000;
      for (int off = -1; off <= 1; ++off)
        nearest = std::min(nearest, difference(picture.at(x, from.y + off), {107, 50, 0}));
      dark += nearest < 70 ? 1 : 0;
    }
    return static_cast<double>(dark) / all;
  };
  EXPECT_GT(ink(-2), 0.98);
  EXPECT_GT(ink(0), 0.5) << "dashed";
  EXPECT_LT(ink(0), 0.85) << "dashed";
  EXPECT_GT(ink(2), 0.1) << "dotted";
  EXPECT_LT(ink(2), 0.5) << "dotted";
  EXPECT_EQ(ink(1), 0) << "between them";
  keep_picture("layer_curbs");
}

TEST_F(PageLayers, ThePathThatWasDriven) {
  put_roads(-3, 3);
  vehicle_x = -8;
  speed = 5;
  open("at=0,0,50,0&follow=0&theme=light&off=relief.curbs.points");
  ASSERT_TRUE(browser->comes_to("curbstone.world.state.pose.x > 0"));
  speed = 0;
  browser->pass(0.3);
  EXPECT_GT(difference(at(-2.03, 0), colour_of(semantic_tile_t::ROAD)), 80);
  EXPECT_TRUE(is_road(-2.03, 0.3)) << "beside it";
  keep_picture("layer_path");
  click_layer("Path");
  EXPECT_TRUE(is_road(-2.03, 0));
}

TEST_F(PageLayers, ThePosesEllipseToScale) {
  put_roads(-2, 2);
  vehicle_sigma = 0.6F;  // 95 % within 1.47 m
  open("at=0,0,60,0&follow=0&theme=light&off=relief.curbs.path.points");
  ASSERT_TRUE(browser->comes_to("curbstone.world.state.pose"));
  browser->pass(0.3);
  const Rgb road = colour_of(semantic_tile_t::ROAD);
  EXPECT_GT(difference(at(0, 1.2), road), 12) << "filled";
  EXPECT_GT(difference(at(0, 0.6 * std::sqrt(5.99)), road), 40) << "its edge";
  EXPECT_TRUE(is_road(0, 1.6)) << "beyond it";
  keep_picture("layer_ellipse");
}

TEST_F(PageLayers, TheLidarsPointsWhereTheyWereMeasured) {
  put_roads(-2, 2);
  vehicle_yaw = std::numbers::pi / 2;
  open("at=0,0,60,0&follow=0&theme=light&off=relief.curbs.path&points=height");
  browser->pass(0.3);  // until the viewer has heard that points are wanted
  for (int revolution = 1; revolution <= 12; ++revolution) {
    lidar_points_t points{};
    points.revolution = revolution;
    points.num_points = 40;
    points.x.assign(40, 2.0F);
    points.y.assign(40, 1.0F);
    points.z.assign(40, 5.0F);
    points.intensity.assign(40, 200);
    points.ring.assign(40, 0);
    points.time_offset.assign(40, 0);
    send("LIDAR_POINTS", points);
    browser->pass(0.1);
  }
  ASSERT_TRUE(browser->comes_to("curbstone.world.scan.length > 0 && !curbstone.world.scanChanged"));
  browser->pass(0.2);
  const Eigen::Vector3d place = config.vehicle.T_base_lidar() * Eigen::Vector3d(2, 1, 5);  // in base_link
  const double x = -place.y(), y = place.x();                                              // it looks along y
  EXPECT_LE(difference(at(x, y), {190, 20, 106}), 16) << ::testing::PrintToString(at(x, y));
  EXPECT_TRUE(is_road(x + 0.2, y));
  keep_picture("layer_points");
  click_layer("LiDAR");
  EXPECT_TRUE(is_road(x, y));
}

TEST_F(PageLayers, HeadingUpTurnsTheMapUnderTheVehicle) {
  put_roads(-2, 2);
  vehicle_yaw = 0.4;
  open("theme=light&follow=1");
  browser->press('n');
  const auto await_yaw = [&] {
    return browser->comes_to(
        fmt::format("Math.abs(curbstone.camera.turn - {}) < 0.005", std::numbers::pi / 2 - vehicle_yaw));
  };
  const auto expect_ahead_is_up = [&] {
    const Spot here = spot_of(0, 0), ahead = spot_of(std::cos(vehicle_yaw), std::sin(vehicle_yaw));
    EXPECT_NEAR(ahead.x, here.x, 1);
    EXPECT_LT(ahead.y, here.y - 10);
  };
  ASSERT_TRUE(await_yaw());
  expect_ahead_is_up();
  keep_picture("heading_up");
  vehicle_yaw = 2.5;
  ASSERT_TRUE(await_yaw());
  expect_ahead_is_up();
  browser->press('n');
  EXPECT_TRUE(browser->comes_to("curbstone.camera.turn === 0"));
}

TEST_F(PageLayers, LatenciesAreFigures) {
  put_roads(-1, 1);
  open("theme=light");
  service_status_t status{};
  status.service = "ekf";
  status.latency_p50 = 0.012F;
  status.latency_p99 = 0.045F;
  send("SERVICE_STATUS", status);
  EXPECT_TRUE(shows("#services", "12 / 45 ms")) << text_of("#services");
  for (int i = 0; i < 6; ++i) {
    put(tile_of(0, 0, i % 2 == 0 ? semantic_tile_t::ROAD : semantic_tile_t::WALL));
    browser->pass(0.2);
  }
  ASSERT_TRUE(shows("#latency", "from sensor to screen"));
  browser->pass(1);  // no tiles come: the figure stands
  const double known = browser->evaluate("1000 * curbstone.world.state.latency[0]");
  const double shown = browser->evaluate(
      "(() => { const words = document.getElementById('latency').textContent;"
      " return parseFloat(words) * (words.includes(' ms') ? 1 : 1000); })()");
  EXPECT_GT(known, 0);
  EXPECT_NEAR(shown, known, 0.05 * known + 1) << text_of("#latency");
}

}  // namespace
}  // namespace curbstone::viewer
