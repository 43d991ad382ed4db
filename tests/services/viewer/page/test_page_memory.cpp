#include <fmt/format.h>

#include "tests/services/viewer/page/page_on_a_bus.hpp"

namespace curbstone::viewer {
namespace {

/// A vehicle that drives the same streets again and again: all that is said is new, and the map grows no more.
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
      if (i % 16 == 15) browser->pass(0.02);
    }
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
  const double end = drive(75);
  EXPECT_LT(end, begin + 3e6) << fmt::format("{:.1f} MB, then {:.1f} MB", begin * 1e-6, end * 1e-6);
  EXPECT_EQ(browser->evaluate("curbstone.world.curbs.size"), 1);
  EXPECT_EQ(browser->evaluate("curbstone.world.tiles.size"), kAside * kAside);
}

}  // namespace
}  // namespace curbstone::viewer
