#include <fmt/format.h>

#include "tests/services/viewer/page/page_on_a_bus.hpp"

namespace curbstone::viewer {
namespace {

constexpr const char* kStraightDown = "at=0,0,40,0&follow=0&theme=light&off=relief.curbs.path.points";

/// A tile that is obstacle at first and road from some time on, while the vehicle drives and tiles go on coming.
class PageRewind : public PageOnABus {
 protected:
  void drive_past_the_change() {
    vehicle_x = 8;
    speed = 1;
    put(tile_of(-1, -1, semantic_tile_t::OBSTACLE));
    open(kStraightDown);
    browser->pass(1.5);
    changed_at_ = browser->evaluate("performance.now()");
    put(tile_of(-1, -1, semantic_tile_t::ROAD));
    put(tile_of(0, -1, semantic_tile_t::WALL));
    browser->pass(2);
    ASSERT_TRUE(browser->comes_to("document.getElementById('timeline').checkVisibility()"));
  }
  void drag_to(double share) {
    const auto box = browser->evaluate(
        "(() => { const b = document.getElementById('position').getBoundingClientRect(); "
        "return [b.left, b.right, (b.top + b.bottom) / 2]; })()");
    const double left = box[0].get<double>() + 8, right = box[1].get<double>() - 8, y = box[2];
    browser->drag(right, y, left + share * (right - left), y);
  }
  /// Half way, for a busy machine lets more time pass on either side than was asked for.
  void drag_before_the_change() { drag_to(share_of("oldest")); }
  void drag_behind_the_change() { drag_to(share_of("newest")); }
  double shown_x() { return browser->evaluate("curbstone.world.state.pose.x"); }
  double live_x() { return browser->evaluate("curbstone.rewind.live.state.pose.x"); }
  int wrong_cells_now(const semantic_tile_t& tile) {
    EXPECT_TRUE(browser->comes_to("curbstone.rewind.isThere && curbstone.world.changed.size === 0"));
    int seen = 0;
    const int wrong = wrong_cells(tile, browser->picture(), &seen);
    EXPECT_GT(seen, 500);
    return wrong;
  }

 private:
  /// Of the bar, half way between the change and an end of the past.
  double share_of(const std::string& end) {
    return browser->evaluate(
        fmt::format("(() => {{ const {{ oldest, newest }} = curbstone.rewind.history; "
                    "return (({} + {}) / 2 - oldest) / (newest - oldest); }})()",
                    end, changed_at_));
  }

  double changed_at_ = 0;  // ms of the page's clock
};

TEST_F(PageRewind, ShowsTheMapAsItWasWhileWhatIsNowGoesOnComing) {
  drive_past_the_change();
  browser->press(' ');  // so that it stands where it is dragged to
  drag_before_the_change();
  EXPECT_EQ(browser->evaluate("curbstone.rewind.isPast"), true);
  EXPECT_TRUE(shows("#status", "ago"));
  const double then = shown_x();
  EXPECT_LT(then, live_x() - 1);
  EXPECT_EQ(wrong_cells_now(tile_of(-1, -1, semantic_tile_t::OBSTACLE)), 0);
  EXPECT_EQ(browser->evaluate("curbstone.world.tiles.size"), 1);  // the other one came later

  put(tile_of(1, 1, semantic_tile_t::ROAD));
  EXPECT_TRUE(browser->comes_to("curbstone.rewind.live.tileAt(1, 1)"));
  EXPECT_EQ(browser->evaluate("curbstone.world.tiles.size"), 1);
  EXPECT_EQ(shown_x(), then);

  browser->evaluate("document.getElementById('live').click()");
  EXPECT_TRUE(shows("#status", "Live"));
  EXPECT_TRUE(browser->comes_to("curbstone.world === curbstone.rewind.live && curbstone.world.tiles.size === 3"));
  EXPECT_EQ(wrong_cells_now(tile_of(-1, -1, semantic_tile_t::ROAD)), 0);
  EXPECT_EQ(wrong_cells_now(tile_of(0, -1, semantic_tile_t::WALL)), 0);
}

TEST_F(PageRewind, PlaysFromThereAndFasterUpToNow) {
  drive_past_the_change();
  browser->press(' ');
  drag_before_the_change();
  const double then = shown_x();
  EXPECT_EQ(wrong_cells_now(tile_of(-1, -1, semantic_tile_t::OBSTACLE)), 0);
  EXPECT_EQ(shown_x(), then) << "it stands until somebody plays it";
  browser->press(' ');
  EXPECT_TRUE(browser->comes_to(fmt::format("curbstone.world.state.pose.x > {}", then + 1)));
  EXPECT_TRUE(browser->comes_to("curbstone.world.tileAt(-1, -1).classes[0] === 1"));
  EXPECT_EQ(browser->evaluate("curbstone.rewind.isPast"), true);
  browser->evaluate("document.getElementById('speed').click()");  // twice the pace
  EXPECT_TRUE(browser->comes_to("!curbstone.rewind.isPast", 120)) << "as long as it is behind";
  EXPECT_TRUE(shows("#status", "Live"));
}

TEST_F(PageRewind, GoesOnThoughTheViewerDiesAndSaysSo) {
  drive_past_the_change();
  browser->press(' ');
  drag_before_the_change();
  stop_viewer();
  EXPECT_TRUE(browser->comes_to("document.getElementById('live').classList.contains('bad')"));
  EXPECT_TRUE(shows("#status", "ago"));
  drag_behind_the_change();
  EXPECT_EQ(wrong_cells_now(tile_of(-1, -1, semantic_tile_t::ROAD)), 0) << text_of("body");
  if (HasFailure()) browser->save_picture(::testing::TempDir() + "page_rewind.png");
  start_viewer(config.port);
  repeat_tiles();
  browser->evaluate("document.getElementById('live').click()");
  EXPECT_TRUE(shows("#status", "Live"));
  EXPECT_TRUE(browser->comes_to("curbstone.world.tiles.size === 2"));
}

TEST_F(PageRewind, MarksWhereANewMapBeganAndMixesNoTilesOfTheTwo) {
  vehicle_x = 8;
  speed = 1;
  put(tile_of(-1, -1, semantic_tile_t::OBSTACLE));
  put(tile_of(0, -1, semantic_tile_t::OBSTACLE));
  open(kStraightDown);
  browser->pass(2.5);
  EXPECT_EQ(browser->evaluate("document.querySelectorAll('#new-maps i').length"), 0);
  vehicle_x = 1;  // near the new map's origin, and hides none of its cells
  begin_epoch();
  vehicle_x = 20;
  put(tile_of(-1, -1, semantic_tile_t::ROAD));
  ASSERT_TRUE(browser->comes_to("curbstone.world.tiles.size === 1 && curbstone.world.tileAt(-1, -1)"));
  browser->pass(2.5);
  ASSERT_TRUE(browser->comes_to("document.querySelectorAll('#new-maps i').length === 1"));
  const double mark = browser->evaluate("+document.querySelector('#new-maps i').style.getPropertyValue('--place')");
  EXPECT_GT(mark, 0.2);
  EXPECT_LT(mark, 0.8);

  browser->press(' ');
  const auto is_the_old_one = [&] {
    EXPECT_EQ(wrong_cells_now(tile_of(-1, -1, semantic_tile_t::OBSTACLE)), 0);
    EXPECT_EQ(wrong_cells_now(tile_of(0, -1, semantic_tile_t::OBSTACLE)), 0);
  };
  const auto is_the_new_one = [&] {
    EXPECT_TRUE(browser->comes_to("curbstone.world.tiles.size === 1"));
    EXPECT_EQ(wrong_cells_now(tile_of(-1, -1, semantic_tile_t::ROAD)), 0);
    int seen = 0;
    EXPECT_GT(wrong_cells(tile_of(0, -1, semantic_tile_t::OBSTACLE), browser->picture(), &seen), 600) << "it is gone";
  };
  drag_to(mark / 2);
  is_the_old_one();
  drag_to((1 + mark) / 2);
  is_the_new_one();
  drag_to(mark / 2);
  is_the_old_one();
  browser->press(' ');  // plays over the mark
  EXPECT_TRUE(
      browser->comes_to("curbstone.world.epoch === curbstone.rewind.live.epoch && curbstone.world.tileAt(-1, -1)"));
  EXPECT_EQ(browser->evaluate("curbstone.rewind.isPast"), true);
  browser->press(' ');
  is_the_new_one();
  keep_picture("new_map");
}

TEST_F(PageRewind, KeepsNoMoreBytesThanItMay) {
  bus_is_alive = false;  // it is about what is kept, not about what is drawn
  open(kStraightDown);
  // A frame of 7 kB with points, ten times a second for an hour, into a history of 0.5 MB.
  const auto kept = browser->evaluate(R"((() => {
    const { rewind, world } = curbstone, history = new rewind.history.constructor(5e5);
    const bytes = new Uint8Array(4 + 5 + 7000);
    bytes[4] = 5;
    new DataView(bytes.buffer).setUint32(5, 7000, true);
    let most = 0;
    for (let at = 0; at < 3_600_000; at += 100) {
      history.expect(world, at);
      history.add(world, bytes.buffer, at);
      most = Math.max(most, history.bytes);
    }
    return [most, history.oldest, history.newest, history.bytes];
  })())");
  EXPECT_LT(kept[0].get<double>(), 6e5) << kept;
  EXPECT_GT(kept[3].get<double>(), 4e5) << kept;
  EXPECT_GT(kept[2].get<double>() - kept[1].get<double>(), 20'000) << "a quarter of the points is kept: " << kept;
}

TEST_F(PageRewind, WhatIsCompressedIsShownAsItWas) {
  drive_past_the_change();
  browser->evaluate("curbstone.rewind.history.mostBytes = 2e5");  // pieces of a few seconds
  const std::string first = "curbstone.rewind.history.segments[0]";
  ASSERT_TRUE(browser->comes_to("curbstone.rewind.history.segments.length > 3 && !" + first + ".frames"));
  drag_before_the_change();
  ASSERT_TRUE(browser->comes_to("curbstone.world.tileAt(-1, -1).classes[0] === 3")) << text_of("#status");
  EXPECT_EQ(browser->evaluate("curbstone.rewind.isPast"), true);
  EXPECT_EQ(browser->evaluate("!!" + first + ".frames"), true);
  EXPECT_TRUE(browser->comes_to("curbstone.world.tileAt(-1, -1).classes[0] === 1")) << "it plays on";
  const double then = shown_x();
  EXPECT_TRUE(browser->comes_to(fmt::format("curbstone.world.state.pose.x > {}", then + 4))) << "over further pieces";
  browser->evaluate("document.getElementById('live').click()");
  EXPECT_TRUE(shows("#status", "Live"));
  EXPECT_TRUE(browser->comes_to("!" + first + ".frames")) << "nobody looks at it";
}

/// What comes with the LiDAR's points shown, and more of it than in a town: half a megabyte a second, most of it tiles.
constexpr const char* kHeavyFrames = R"(
    let seed = 1;
    const lot = n => (seed = seed * 1103515245 + 12345 & 0x7fffffff, (seed >> 8) % n);
    const frameOf = (round, tiles, points) => {
      const bytes = new Uint8Array(tiles * 500 + points * 7 + 100), view = new DataView(bytes.buffer);
      let at = 4;
      const begin = kind => { bytes[at] = kind; at += 5; return at; };
      const end = from => view.setUint32(from - 4, at - from, true);
      const section = begin(2);
      view.setFloat64(at, round, true); at += 8;
      for (let n = 0; n < tiles; ++n) {
        view.setInt32(at, lot(20), true); view.setInt32(at + 4, Math.floor(round / 60) % 500 + lot(20), true);
        bytes[at + 8] = 1; view.setInt32(at + 9, round, true);
        view.setFloat64(at + 13, round * 1e5, true); view.setFloat64(at + 21, round * 1e5, true); at += 33;
        const mask = at, cells = [];
        at += 79;
        for (let i = lot(40); i < 625; i += 1 + lot(30)) { bytes[mask + (i >> 3)] |= 1 << (i & 7); cells.push(i); }
        for (const _ of cells) bytes[at++] = 1 + lot(4);
        for (const _ of cells) { view.setInt16(at, lot(60), true); at += 2; }
        for (const _ of cells) bytes[at++] = lot(3) ? 0 : lot(255);
        for (const _ of cells) bytes[at++] = 200 + lot(55);
      }
      end(section);
      const scan = begin(5);
      for (let n = 0; n < points; ++n) {
        for (let axis = 0; axis < 3; ++axis) { view.setInt16(at, lot(6000) - 3000, true); at += 2; }
        bytes[at++] = lot(256);
      }
      end(scan);
      return bytes.slice(0, at).buffer;
    };)";

TEST_F(PageRewind, KeepsTenMinutesOfHalfAMegabyteASecondInItsBounds) {
  bus_is_alive = false;
  open(kStraightDown);
  browser->evaluate(std::string("window.fill = async () => {") + kHeavyFrames + R"(
    const { rewind, world } = curbstone, { live } = rewind, World = world.constructor, kept = new World();
    kept.begin(1, 1);
    let most = 0, all = 0;
    window.past = new rewind.history.constructor();
    const frames = Array.from({ length: 30 }, (_, i) => frameOf(i, 620, 10_500));  // far more than deflate looks back
    for (let at = 0; at <= 620_000; at += 500) {
      const frame = frames[at / 500 % frames.length];
      all += frame.byteLength;
      past.expect(kept, at);
      if (at % 20_000 === 0) kept.copied += 400;  // tiles that change while a snapshot holds them
      past.add(kept, frame, at);
      if (at % 10_000 === 0) await past.packing;
      most = Math.max(most, past.bytes);
    }
    await past.packing;
    return [past.newest - past.oldest, most, all / 620, past.bytes];
  }; 0)");
  const auto kept = browser->evaluate("fill()");
  EXPECT_NEAR(kept[2].get<double>(), 5e5, 5e4) << "bytes a second: " << kept;
  EXPECT_GE(kept[0].get<double>(), 600'000) << "ms: " << kept;
  EXPECT_LE(kept[1].get<double>(), 150e6) << kept;
}

}  // namespace
}  // namespace curbstone::viewer
