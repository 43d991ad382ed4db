#include "services/viewer/frames/page_feed.hpp"
#include "tests/services/viewer/page/page_on_a_bus.hpp"

namespace curbstone::viewer {
namespace {

/// A page that is opened before anything speaks.
class PageWaits : public PageOnABus {
 protected:
  void SetUp() override {
    bus_is_alive = false;
    PageOnABus::SetUp();
  }
};

TEST_F(PageWaits, AndSaysInWordsForWhat) {
  browser->resize(640, 520);
  browser->open(address);
  service_status_t status{};
  status.service = "viewer";
  send("SERVICE_STATUS", status);  // its own, which comes back from the bus
  EXPECT_TRUE(shows("#curtain", "Nothing has been heard on the bus yet")) << text_of("body");
  EXPECT_EQ(text_of("#status"), "Waiting");
  status.service = "lidar";
  send("SERVICE_STATUS", status);
  EXPECT_TRUE(shows("#curtain", "No pose has come from the mapper yet")) << text_of("body");
  EXPECT_EQ(browser->evaluate("document.getElementById('timeline').hidden"), true) << "nothing to look back to";
  status.service = "mapper";
  status.fault = {"no LIDAR_POINTS"};
  status.num_faults = 1;
  send("SERVICE_STATUS", status);
  status.service = "lidar";
  status.fault = {"no packets for 4.0 s on port 6699"};
  send("SERVICE_STATUS", status);
  EXPECT_TRUE(shows("#curtain", "lidar: no packets for 4.0 s on port 6699", 5)) << "why: " << text_of("#curtain");
  bus_is_alive = true;
  EXPECT_TRUE(shows("#curtain", "No map has come from semantic_map yet")) << text_of("body");
  put(tile_of(0, 0, semantic_tile_t::ROAD));
  EXPECT_TRUE(browser->comes_to("document.getElementById('curtain').hidden"));
  EXPECT_TRUE(shows("#status", "Live"));
}

/// A page that is opened when the map is there.
class PageArrives : public PageOnABus {};

TEST_F(PageArrives, AndDrawsItsFirstPictureOnceThoughTheMapComesInTenFrames) {
  constexpr int kTiles = 640;
  static_assert(kTiles >= 10 * static_cast<int>(frames::PageFeed::kMaxWholeTiles));
  for (int i = 0; i < kTiles; ++i) put(tile_of(i % 32, i / 32, semantic_tile_t::ROAD));
  open("follow=0&theme=light");
  ASSERT_TRUE(browser->comes_to("curbstone.initialLoad.shown"));
  // Twice a second it draws what has come, whoever waits so long; and once more at its beginning, when its size is
  // known.
  EXPECT_LE(browser->evaluate("curbstone.initialLoad.parts - curbstone.initialLoad.asked").get<int>(), 1);
}

}  // namespace
}  // namespace curbstone::viewer
