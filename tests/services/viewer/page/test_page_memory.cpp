#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "common/time/clock.hpp"
#include "tests/services/viewer/page/page_on_a_bus.hpp"

namespace curbstone::viewer {
namespace {

/// A vehicle that drives the same street up and down: all that is said is new, and the map grows no more.
class PageMemory : public PageOnABus {
 protected:
  static constexpr int kAside = 8;  // tiles

  void SetUp() override {
    config.frame_period = 0.02;
    PageOnABus::SetUp();
    if (!IsSkipped()) browser->resize(640, 520);
  }
  /// Every tile anew, a curb, a line of paint, the LiDAR's points; `round` makes each other than before.
  void drive_round(int round) {
    for (int i = 0; i < kAside * kAside; ++i) {
      semantic_tile_t tile = tile_of(i % kAside - kAside / 2, i / kAside - kAside / 2, semantic_tile_t::ROAD);
      for (int k = 0; k < 60; ++k) {
        tile.cell_class[(37 * k + 11 * round + i) % 625] = semantic_tile_t::OBSTACLE;
        tile.height[(53 * k + 7 * round + i) % 625] = static_cast<std::int16_t>(round % 50);
      }
      put(tile);
      if (i % 16 != 15) continue;
      send_revolution();
      browser->pass(0.02);
    }
    speed = round % 2 == 0 ? 2 : -2;
    const float shift = 0.001F * static_cast<float>(round % 100);
    curb_line_t curb{};
    marking_line_t paint{};
    for (int i = 0; i < 200; ++i) {
      for (auto* list : {&curb.x, &paint.x}) list->push_back(-10 + 0.1F * static_cast<float>(i));
      for (auto* list : {&curb.y, &paint.y}) list->push_back(shift);
      for (auto* list : {&curb.z, &curb.height, &curb.high_side_x, &paint.z}) list->push_back(0);
      curb.high_side_y.push_back(1);
      paint.painted.push_back(1);
    }
    curb.num_points = paint.num_points = 200;
    send_box<curb_lines_t>("CURBS", curb);
    send_box<marking_lines_t>("MARKINGS", paint);
  }
  /// 2,000 points all around, each time others.
  void send_revolution() {
    lidar_points_t points{};
    points.utime = wall_clock();
    points.revolution = ++revolution_;
    points.num_points = 2000;
    for (int i = 0; i < points.num_points; ++i) {
      const float angle = 0.00314F * static_cast<float>(i + revolution_ % 7);
      points.x.push_back(8 * std::cos(angle));
      points.y.push_back(8 * std::sin(angle));
      points.z.push_back(0.001F * static_cast<float>((i + revolution_) % 900));
      points.intensity.push_back(static_cast<std::uint8_t>((i + revolution_) % 256));
      points.ring.push_back(static_cast<std::uint8_t>(i % 16));
      points.time_offset.push_back(0);
    }
    send("LIDAR_POINTS", points);
  }
  template <class Message, class Line>
  void send_box(const std::string& channel, const Line& line) {
    Message message{};
    message.epoch = epoch();
    message.box_min[0] = message.box_min[1] = -50;
    message.box_max[0] = message.box_max[1] = 50;
    message.num_lines = 1;
    message.lines = {line};
    send(channel, message);
  }

 private:
  std::int32_t revolution_ = 0;
};

TEST_F(PageMemory, StaysFlatHoweverLongTheDrive) {
  drive_round(0);
  open("at=0,0,20,0&follow=0&theme=light");
  // Ten minutes of what came may take 150 MB; the bound is the same with less, and reached in a test.
  (void)browser->evaluate("+(curbstone.rewind.history.mostBytes = 2e6)");
  int round = 0;
  const auto drive = [&](int rounds) {
    for (const int end = round + rounds; round < end;) drive_round(++round);
    return browser->memory();
  };
  const double begin = drive(25);
  EXPECT_GT(browser->evaluate("curbstone.rewind.history.bytes").get<double>(), 1e5);
  EXPECT_LT(browser->evaluate("curbstone.rewind.history.bytes").get<double>(), 4e6);
  const auto scan = [&] { return browser->evaluate("curbstone.world.scan.reduce((sum, value) => sum + value, 0)"); };
  const auto [x, points] = std::pair{browser->evaluate("curbstone.world.state.pose.x"), scan()};
  const double end = drive(75);
  EXPECT_NE(browser->evaluate("curbstone.world.state.pose.x"), x) << "it drives";
  EXPECT_GT(browser->evaluate("curbstone.world.scan.length").get<int>(), 4000);
  EXPECT_NE(scan(), points) << "the points are new ones";
  EXPECT_LT(end, begin + 3e6) << fmt::format("{:.1f} MB, then {:.1f} MB", begin * 1e-6, end * 1e-6);
  EXPECT_EQ(browser->evaluate("curbstone.world.curbs.size"), 1);
  EXPECT_EQ(browser->evaluate("curbstone.world.tiles.size"), kAside * kAside);
}

}  // namespace
}  // namespace curbstone::viewer
