#pragma once

#include <curbstone/semantic_tile_t.hpp>
#include <functional>
#include <memory>
#include <string>

#include "common/bus/local_bus.hpp"
#include "services/viewer/viewer_node.hpp"
#include "services/viewer/web/web_server.hpp"
#include "tools/browser/browser.hpp"

namespace curbstone::bench::viewer {

/// The viewer on a bus of its own with a page of it in Chromium, which draws in software. A mapper says poses, so that
/// the page is live. One thread; what goes wrong is a std::runtime_error.
class LivePage {
 public:
  LivePage();

  /// A new revision of a tile, measured now.
  void put(semantic_tile_t tile);
  /// `fragment`: what the page's address says after #.
  void open(const std::string& fragment);
  /// Lets the viewer run meanwhile.
  void pass(double seconds) { browser_.pass(seconds); }
  /// A number, of a promise too.
  double evaluate(const std::string& expression) { return browser_.evaluate(expression).get<double>(); }
  /// Waits four minutes at most: a large map on a busy machine.
  void wait_for(const std::string& condition);
  /// What is to be done while the browser is waited for.
  std::function<void()> meanwhile = [] {};

 private:
  void go_on();

  LocalBus bus_;
  std::int32_t epoch_ = 0;
  std::int32_t revision_ = 0;
  std::int64_t said_ = 0;  // us, the last pose
  std::unique_ptr<curbstone::viewer::web::WebServer> server_;
  std::unique_ptr<curbstone::viewer::ViewerNode> node_;
  std::string address_;
  browser::Browser browser_;
};

}  // namespace curbstone::bench::viewer
