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
  say("SERVICE_STATUS", status);  // its own, which comes back from the bus
  EXPECT_TRUE(shows("#curtain", "Nothing has been heard on the bus yet")) << text_of("body");
  EXPECT_EQ(text_of("#status"), "Waiting");
  status.service = "lidar";
  say("SERVICE_STATUS", status);
  EXPECT_TRUE(shows("#curtain", "No pose has come from the mapper yet")) << text_of("body");
  EXPECT_EQ(browser->evaluate("document.getElementById('timeline').hidden"), true) << "nothing to look back to";
  bus_is_alive = true;
  EXPECT_TRUE(shows("#curtain", "No map has come from semantic_map yet")) << text_of("body");
  put(tile_of(0, 0, semantic_tile_t::ROAD));
  EXPECT_TRUE(browser->comes_to("document.getElementById('curtain').hidden"));
  EXPECT_TRUE(shows("#status", "Live"));
}

}  // namespace
}  // namespace curbstone::viewer
