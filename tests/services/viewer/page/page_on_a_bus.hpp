#pragma once

#include <gmock/gmock.h>

#include <curbstone/curb_lines_t.hpp>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/local_bus.hpp"
#include "services/viewer/viewer_node.hpp"
#include "services/viewer/web/web_server.hpp"
#include "tests/temporary_folder.hpp"
#include "tools/browser/browser.hpp"

namespace curbstone::viewer {

using curbstone::browser::difference;

/// The viewer on a bus of the test's, and its page in a real browser. What the test has said of the map is kept here,
/// so that the pixels can be compared with it.
class PageOnABus : public ::testing::Test {
 protected:
  static constexpr int kCells = 25;
  static constexpr double kCell = 0.12;  // m
  using Rgb = curbstone::browser::Rgb;
  using Picture = curbstone::browser::Picture;
  struct Spot {
    double x;  // pixels
    double y;
  };

  void SetUp() override;
  /// A page that threw, or asked for what its policy refuses, has failed.
  void TearDown() override;

  /// `fragment`: what the page's address says after #. Waits for all tiles.
  void open(const std::string& fragment);
  void start_viewer(int port = 0);
  void stop_viewer();
  /// What there is to hear again is sent to a new viewer, as TILE_INDEX and requests do on the bus.
  void repeat_tiles();

  /// The mapper has started anew: what is said from here on is of another map.
  void begin_epoch();
  void put(const semantic_tile_t& tile);
  /// The page then has the time line of a log; `ended` or not.
  void send_playback(bool paused = false, bool ended = false);
  /// A square of road: tiles from .. to - 1 in x and y.
  void put_roads(int from, int to);
  /// Vertices at these x, m; the higher side is that of greater y.
  [[nodiscard]] static curb_line_t curb_along(const std::vector<float>& x, float y, float height);
  void send_curbs(const std::vector<curb_line_t>& lines);
  [[nodiscard]] semantic_tile_t tile_of(int x, int y, std::int8_t cell_class) const;
  [[nodiscard]] static Rgb colour_of(int cell_class);  // light theme; of none: the paper's is no colour
  /// Where the page has a place of the map.
  Spot spot_of(double x, double y);
  /// What the page shows of the tile, cell by cell, against what was said: how many cells are of another colour. Cells
  /// under a card or beyond the window do not count; `seen` is how many did.
  int wrong_cells(const semantic_tile_t& tile, const Picture& picture, int* seen);
  std::string text_of(const std::string& selector);
  /// A picture to look at, if CURBSTONE_TEST_PICTURES names a folder for them.
  void keep_picture(const std::string& name);
  bool shows(const std::string& selector, const std::string& words, double seconds = 30);

  double vehicle_x = 0;               // m, and as fast as the test says
  double speed = 0;                   // m/s
  double vehicle_yaw = 0;             // rad
  float vehicle_sigma = 0;            // m, of its position
  bool bus_is_alive = true;           // whether poses come
  bool map_speaks = false;            // whether semantic_map tells its state, twice a second
  bool map_announces = false;         // whether it tells its tiles, twice a second
  std::optional<double> localized_x;  // m, with each pose; empty: there is no localizer
  std::map<std::pair<int, int>, semantic_tile_t> tiles;
  ViewerConfig config;
  std::optional<curbstone::browser::Browser> browser;
  std::string address;

 private:
  void go_on();
  void send_pose();
  void send_map_news();

  std::int64_t epoch_ = 0;
  std::int32_t revision_ = 0;
  std::int64_t said_ = 0;
  std::int64_t told_ = 0;  // us, of the map
  std::unique_ptr<LocalBus> bus_;
  std::unique_ptr<web::WebServer> server_;
  std::unique_ptr<ViewerNode> node_;

 protected:
  [[nodiscard]] LocalBus& bus() { return *bus_; }
  /// What comes while no viewer runs is lost.
  void inject(const std::string& channel, const void* data, int size) {
    if (node_) bus_->inject(channel, data, size);
  }
  template <class Message>
  void send(const std::string& channel, const Message& message) {
    bus_->publish(channel, message);
    bus_->dispatch();
  }
  [[nodiscard]] std::int32_t epoch() const { return static_cast<std::int32_t>(epoch_); }
};

}  // namespace curbstone::viewer
