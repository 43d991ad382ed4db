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

/// The viewer on its own bus, and a page of it in Chromium, which renders in software. Poses are published as by a
/// mapper, so that the page is live. One thread. Errors are std::runtime_error.
class LivePage {
 public:
  LivePage();

  /// Publishes a new revision of a tile, measured now.
  void put(semantic_tile_t tile);
  /// `fragment`: the part of the page's address after #.
  void open(const std::string& fragment);
  /// Waits; the viewer runs meanwhile.
  void pass(double seconds) { browser_.pass(seconds); }
  /// The number that an expression yields; a promise is awaited.
  double evaluate(const std::string& expression) { return browser_.evaluate(expression).get<double>(); }
  /// Waits at most four minutes, for a large map on a busy machine.
  void wait_for(const std::string& condition);
  /// Called while waiting for the browser.
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
