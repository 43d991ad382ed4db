#include "services/viewer/frames/page_feed.hpp"

#include <gtest/gtest.h>

#include "services/viewer/frames/tile_records.hpp"
#include "tests/services/viewer/frame_reader.hpp"
#include "tests/services/viewer/tiles.hpp"

namespace curbstone::viewer::frames {
namespace {

/// A map that lives, and pages that watch it on lines of their own.
class PageFeedTest : public ::testing::Test {
 protected:
  void change(TileKey key) {
    const store::TileCells* before = map_.at(key);
    const store::TileCells cells =
        before == nullptr ? draw_cells(random_, 1) : change_cells(random_, *before, before->revision + 1);
    steps_.will_change(key, before);
    map_.put(key, cells);
    newest_utime_ = std::max(newest_utime_, cells.utime);
  }
  void begin_epoch() {
    map_.clear();
    steps_.clear(map_);
    curbs_.clear();
    path_.clear();
    ++epoch_;
  }
  [[nodiscard]] World world() {
    return {.run = 42,
            .epoch = epoch_,
            .map = map_,
            .steps = steps_,
            .curbs = curbs_,
            .markings = markings_,
            .path = path_,
            .scan = scan_,
            .scan_number = scan_number_,
            .services = "[]",
            .services_number = 1,
            .newest_utime = newest_utime_,
            .now = now_};
  }
  std::vector<std::uint8_t> make(PageFeed& feed) {
    steps_.close(map_);
    return feed.make(world(), "{}");
  }
  /// Sends and draws until the page lacks nothing.
  void level(PageFeed& feed, FrameReader& page) {
    for (int frames = 0; frames < 100; ++frames) {
      feed.drawn(page.read(make(feed)));
      if (page.number == static_cast<double>(map_.number())) return;
    }
    FAIL() << "never level";
  }
  [[nodiscard]] TileKey any_key() { return {static_cast<int>(random_() % 12), static_cast<int>(random_() % 12)}; }
  void expect_same(const FrameReader& page) {
    ASSERT_EQ(page.tiles.size(), map_.size());
    for (const auto& [key, tile] : page.tiles) {
      ASSERT_NE(map_.at(key), nullptr);
      EXPECT_EQ(tile, *map_.at(key)) << key.x << ", " << key.y;
    }
  }

  std::mt19937 random_{7};
  std::int32_t epoch_ = 1;
  store::LiveMap map_;
  TileSteps steps_;
  store::CurbLines curbs_;
  store::MarkingLines markings_;
  store::ThinnedPath path_;
  std::vector<ScanPoint> scan_;
  std::uint64_t scan_number_ = 0;
  std::int64_t now_ = 0;
  std::int64_t newest_utime_ = 0;
};

TEST_F(PageFeedTest, RoadMarkingsGoOnceAndAreTakenBack) {
  marking_lines_t message{};
  message.box_max[0] = message.box_max[1] = 10;
  message.num_lines = 1;
  marking_line_t& line = message.lines.emplace_back();
  line.type = marking_line_t::STOP_LINE;
  line.width = 0.5F;
  line.x = {1, 2, 3};
  line.y = line.z = {0, 0, 0};
  line.painted = {1, 0, 0};
  line.num_points = 3;
  ASSERT_EQ(markings_.put(message), store::MarkingLines::Put::kTaken);
  PageFeed feed(std::nullopt);
  FrameReader page;
  feed.drawn(page.read(make(feed)));
  ASSERT_EQ(page.markings.size(), 1U);
  const auto& [name, marking] = *page.markings.begin();
  EXPECT_EQ(marking.type, int{marking_line_t::STOP_LINE});
  EXPECT_FLOAT_EQ(marking.width, 0.5F);
  EXPECT_EQ(marking.x, line.x);
  EXPECT_EQ(marking.painted, (std::vector<int>{1, 0, 0}));
  message.lines.clear();
  message.num_lines = 0;
  markings_.put(message);
  feed.drawn(page.read(make(feed)));
  EXPECT_TRUE(page.markings.empty());
}

TEST_F(PageFeedTest, ANewPageGetsTheWholeMapInFramesOfBoundedSize) {
  for (int i = 0; i < 200; ++i) change({i, -i});
  PageFeed feed(std::nullopt);
  FrameReader page;
  int frames = 0;
  while (page.number != 200) {
    const auto frame = make(feed);
    EXPECT_LT(frame.size(), PageFeed::kMaxWholeTiles * kWholeTile + 1000);
    feed.drawn(page.read(frame));
    ASSERT_LT(++frames, 10);
  }
  expect_same(page);
  EXPECT_EQ(page.begins, 1);
  EXPECT_EQ(page.run, 42);
}

TEST_F(PageFeedTest, ALevelPageGetsOnlyTheCellsThatChanged) {
  for (int i = 0; i < 50; ++i) change({i, 0});
  PageFeed feed(std::nullopt);
  FrameReader page;
  level(feed, page);
  change({3, 0});
  const auto frame = make(feed);
  EXPECT_LT(frame.size(), 500U);
  feed.drawn(page.read(frame));
  expect_same(page);
}

TEST_F(PageFeedTest, AtMostTwoFramesAreOut) {
  change({0, 0});
  PageFeed feed(std::nullopt);
  make(feed);
  EXPECT_TRUE(feed.may_send());
  make(feed);
  EXPECT_FALSE(feed.may_send());
  EXPECT_FALSE(feed.drawn(3).has_value());
  EXPECT_TRUE(feed.drawn(2).has_value()) << "who has drawn the second has drawn the first";
  EXPECT_TRUE(feed.may_send());
  EXPECT_FALSE(feed.drawn(2).has_value());
}

TEST_F(PageFeedTest, ResumesWhereThePageWasAndOnlyThere) {
  for (int i = 0; i < 100; ++i) change({i, 0});
  PageFeed first(std::nullopt);
  FrameReader page;
  level(first, page);
  change({5, 0});
  change({200, 0});
  PageFeed again({{.run = page.run, .epoch = page.epoch, .number = static_cast<std::uint64_t>(page.number)}});
  const auto frame = make(again);
  EXPECT_LT(frame.size(), 3 * kWholeTile);
  page.read(frame);
  EXPECT_EQ(page.begins, 1);
  expect_same(page);

  const auto starts_anew = [&](PageFeed::Resume resume) {
    PageFeed feed(resume);
    FrameReader fresh;
    fresh.read(make(feed));
    return fresh.begins == 1;
  };
  EXPECT_TRUE(starts_anew({.run = 43, .epoch = 1, .number = 5}));
  EXPECT_TRUE(starts_anew({.run = 42, .epoch = 2, .number = 5}));
  EXPECT_TRUE(starts_anew({.run = 42, .epoch = 1, .number = 5000}));
}

TEST_F(PageFeedTest, ANewEpochVoidsWhatThePageHas) {
  PageFeed feed(std::nullopt);
  FrameReader page;
  change({1, 1});
  level(feed, page);
  begin_epoch();
  change({2, 2});
  level(feed, page);
  EXPECT_EQ(page.begins, 2);
  EXPECT_EQ(page.epoch, 2);
  expect_same(page);
}

TEST_F(PageFeedTest, TellsHowNewTheDrawnTilesAre) {
  PageFeed feed(std::nullopt);
  FrameReader page;
  change({1, 1});
  const std::uint32_t first = page.read(make(feed));
  EXPECT_EQ(feed.drawn(first), newest_utime_);
  EXPECT_EQ(feed.drawn(page.read(make(feed))), 0) << "nothing newer";
}

TEST_F(PageFeedTest, SendsPathAndPointsToWhoWantsThem) {
  path_.put({.utime = 1, .x = 1});
  scan_ = {{1, 2, 3, 4}, {5, 6, 7, 8}};
  scan_number_ = 1;
  PageFeed feed(std::nullopt);
  FrameReader page;
  feed.drawn(page.read(make(feed)));
  EXPECT_EQ(page.path.size(), 3U);
  EXPECT_EQ(page.num_points, 0U);
  feed.want_points(true);
  path_.put({.utime = 2, .x = 2});
  feed.drawn(page.read(make(feed)));
  EXPECT_EQ(page.path, (std::vector<float>{1, 0, 0, 2, 0, 0}));
  EXPECT_EQ(page.num_points, 2U);
  path_.put({.utime = 1, .x = 1, .y = 9});
  feed.drawn(page.read(make(feed)));
  EXPECT_EQ(page.path, (std::vector<float>{1, 9, 0, 1, 0, 0, 2, 0, 0}));
}

TEST_F(PageFeedTest, SendsPointsFiveTimesASecond) {
  scan_ = {{1, 2, 3, 4}};
  PageFeed feed(std::nullopt);
  feed.want_points(true);
  int sent = 0;
  for (now_ = 0; now_ < 2'000'000; now_ += 50'000) {
    ++scan_number_;
    FrameReader page;
    feed.drawn(page.read(make(feed)));
    sent += page.num_points > 0 ? 1 : 0;
  }
  EXPECT_EQ(sent, 10);
}

/// Pages that draw late, that reconnect in the middle of a frame, and a map that goes on meanwhile, now and then in a
/// new epoch.
TEST_F(PageFeedTest, WhateverIsLostAPageComesToTheSameMap) {
  struct Watcher {
    std::optional<PageFeed> feed{std::in_place, std::nullopt};
    FrameReader page;
    std::vector<std::uint32_t> undrawn;
  };
  std::vector<Watcher> watchers(6);
  for (int round = 0; round < 1500; ++round) {
    for (auto n = random_() % 8; n > 0; --n) change(any_key());
    if (round % 400 == 399) begin_epoch();
    for (Watcher& watcher : watchers) {
      if (random_() % 3 == 0 && watcher.feed->may_send()) {
        const auto frame = make(*watcher.feed);
        if (random_() % 20 == 0) {  // the connection broke: what was on its way is lost
          watcher.undrawn.clear();
          watcher.feed.emplace(PageFeed::Resume{.run = watcher.page.run,
                                                .epoch = watcher.page.epoch,
                                                .number = static_cast<std::uint64_t>(watcher.page.number)});
          continue;
        }
        watcher.undrawn.push_back(watcher.page.read(frame));
      }
      if (random_() % 4 == 0 && !watcher.undrawn.empty()) {
        EXPECT_TRUE(watcher.feed->drawn(watcher.undrawn.back()).has_value());
        watcher.undrawn.clear();
      }
    }
  }
  for (Watcher& watcher : watchers) {
    if (!watcher.undrawn.empty()) watcher.feed->drawn(watcher.undrawn.back());
    level(*watcher.feed, watcher.page);
    expect_same(watcher.page);
  }
}

TEST_F(PageFeedTest, StepsAreBounded) {
  for (int round = 0; round < 200; ++round) {
    change({round, 0});
    steps_.close(map_);
  }
  const auto way = steps_.from(200 - TileSteps::kMaxSteps);
  ASSERT_TRUE(way.has_value());
  EXPECT_EQ(way->size(), TileSteps::kMaxSteps);
  EXPECT_FALSE(steps_.from(200 - TileSteps::kMaxSteps - 1).has_value());
  for (int i = 0; i < 300; ++i) change({i, 1});
  steps_.close(map_);
  EXPECT_FALSE(steps_.from(200).has_value()) << "one step of a megabyte is none";
  EXPECT_TRUE(steps_.from(500).has_value());
}

}  // namespace
}  // namespace curbstone::viewer::frames
