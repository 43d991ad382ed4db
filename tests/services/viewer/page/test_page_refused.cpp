// A page that cannot work says why.
#include "tests/services/viewer/page/page_on_a_bus.hpp"

namespace curbstone::viewer {
namespace {

class PageRefused : public PageOnABus {};

/// As many pages as the viewer has room for.
class PageTooMany : public PageOnABus {
 protected:
  PageTooMany() { config.pages = 1; }
};

TEST_F(PageTooMany, SaysSoAndComesInWhenThereIsRoom) {
  put(tile_of(0, 0, semantic_tile_t::ROAD));
  open("theme=light");
  curbstone::browser::Browser second([this] { browser->pass(0.001); }, 900, 600);
  second.open(address);
  EXPECT_TRUE(second.comes_to("document.getElementById('curtain').innerText.includes('no more pages')"))
      << second.evaluate("document.body.innerText");
  EXPECT_EQ(second.evaluate("document.getElementById('status').innerText"), "Refused");
  browser->open("about:blank");
  EXPECT_TRUE(second.comes_to("curbstone.world.tiles.size === 1 && document.getElementById('curtain').hidden"));
}

TEST_F(PageRefused, ThroughAProxyThatHidesTheHostItSaysWhatAProxyMustDo) {
  put(tile_of(0, 0, semantic_tile_t::ROAD));
  open("theme=light");
  browser->evaluate(R"((() => {
    window.WebSocket = class { constructor() { setTimeout(() => this.onclose()); } close() {} };
  })())");
  stop_viewer();
  ASSERT_TRUE(shows("#status", "No connection"));
  start_viewer(config.port);
  EXPECT_TRUE(shows("#curtain", "must pass on the Host header")) << text_of("#curtain");
}

TEST_F(PageRefused, ABrowserWithoutWebGl2IsToldWhatToDo) {
  browser->at_the_beginning(R"((() => {
    const before = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
      return kind === 'webgl2' ? null : before.call(this, kind, ...more);
    };
  })())");
  browser->open(address);
  EXPECT_TRUE(shows("#curtain", "no WebGL2. Switch its graphics acceleration on"));
  EXPECT_EQ(text_of("#status"), "Cannot draw");
  EXPECT_FALSE(browser->evaluate("document.getElementById('tools').checkVisibility()").get<bool>())
      << "a button that does nothing";
}

TEST_F(PageRefused, ItsFilesLieBesideIt) {
  open("theme=light");
  const auto absolute = browser->evaluate(
      "[...document.querySelectorAll('[src], link[href]')].map(e => e.getAttribute('src') ?? e.getAttribute('href'))"
      ".filter(address => address.startsWith('/') || address.includes(':'))");
  EXPECT_TRUE(absolute.empty()) << "behind a proxy's path: " << absolute;
}

}  // namespace
}  // namespace curbstone::viewer
