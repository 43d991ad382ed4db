#include "tests/services/viewer/page/page_on_a_bus.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>

#include "common/time/clock.hpp"

namespace curbstone::viewer {
namespace {

constexpr std::int64_t kRevolution = 50'000;  // us
constexpr std::int64_t kMapNews = 500'000;    // us
constexpr int kTolerance = 4;                 // of 255: what rounding in shaders makes

}  // namespace

void PageOnABus::SetUp() {
  if (!curbstone::browser::Browser::is_installed())
    GTEST_SKIP() << "no chromium-headless-shell: scripts/install-deps --long";
  epoch_ = wall_clock() / 1'000'000 - 100;
  start_viewer();
  browser.emplace([this] { go_on(); });
}

void PageOnABus::TearDown() {
  if (browser) {
    EXPECT_THAT(browser->complaints(), ::testing::IsEmpty());
  }
}

void PageOnABus::start_viewer(int port) {
  config.port = port;
  bus_ = std::make_unique<LocalBus>();
  server_ = std::make_unique<web::WebServer>(web_settings(config));
  node_ = std::make_unique<ViewerNode>(config, *bus_, *server_, ViewerNode::Source{});
  node_->connect(*bus_);
  node_->tick(wall_clock());
  address = page_address(config, server_->port());
}

void PageOnABus::stop_viewer() {
  config.port = server_->port();
  node_.reset();
  server_.reset();
}

void PageOnABus::repeat_tiles() {
  for (const auto& [key, tile] : tiles) send("SEMANTIC_TILE", tile);
}

void PageOnABus::go_on() {
  if (!node_) return;
  const std::int64_t now = wall_clock();
  if (bus_is_alive && now - said_ >= kRevolution) {
    if (said_ > 0) vehicle_x += speed * static_cast<double>(now - said_) * 1e-6;
    said_ = now;
    send_pose();
  }
  if (now - told_ >= kMapNews) {
    told_ = now;
    send_map_news();
  }
  node_->tick(now);
  bus_->dispatch();
}

curb_line_t PageOnABus::curb_along(const std::vector<float>& x, float y, float height) {
  curb_line_t line{};
  line.num_points = static_cast<std::int32_t>(x.size());
  line.x = x;
  line.y.assign(x.size(), y);
  line.z.assign(x.size(), 0);
  line.height.assign(x.size(), height);
  line.high_side_x.assign(x.size(), 0);
  line.high_side_y.assign(x.size(), 1);
  line.confidence = 1;
  return line;
}

void PageOnABus::send_curbs(const std::vector<curb_line_t>& lines) {
  curb_lines_t curbs{};
  curbs.epoch = epoch();
  curbs.box_min[0] = curbs.box_min[1] = -20;
  curbs.box_max[0] = curbs.box_max[1] = 20;
  curbs.num_lines = static_cast<std::int32_t>(lines.size());
  curbs.lines = lines;
  send("CURBS", curbs);
}

void PageOnABus::send_map_news() {
  service_status_t status{};
  status.service = "semantic_map";
  if (map_speaks) send("SERVICE_STATUS", status);
  tile_index_t index{};
  index.owner = "semantic_map";
  index.channel = "SEMANTIC_TILE";
  index.epoch = epoch();
  index.num_pages = 1;
  if (map_announces) send("TILE_INDEX", index);
}

void PageOnABus::send_pose() {
  map_pose_t pose{};
  pose.utime = said_;
  pose.epoch = epoch();
  pose.map_base_position[0] = vehicle_x;
  pose.map_odom_orientation[0] = 1;
  pose.map_base_orientation[0] = std::cos(vehicle_yaw / 2);
  pose.map_base_orientation[3] = std::sin(vehicle_yaw / 2);
  pose.covariance[0] = pose.covariance[7] = vehicle_sigma * vehicle_sigma;
  pose.flags = map_pose_t::REGISTERED;
  send("MAP_POSE", pose);
  if (!localized_x) return;
  pose.map_base_position[0] = *localized_x;
  send("LOCALIZED_POSE", pose);
}

void PageOnABus::begin_epoch() {
  epoch_ += 50;
  tiles.clear();
  browser->pass(0.2);  // the mapper's poses announce it
}

void PageOnABus::send_playback(bool paused, bool ended) {
  node_->set_playback({.position = 12, .progress = 0.4, .speed = 1, .paused = paused, .ended = ended});
}

void PageOnABus::put(const semantic_tile_t& tile) {
  tiles[{tile.tile_x, tile.tile_y}] = tile;
  tiles[{tile.tile_x, tile.tile_y}].revision = ++revision_;
  send("SEMANTIC_TILE", tiles[{tile.tile_x, tile.tile_y}]);
}

void PageOnABus::put_roads(int from, int to) {
  for (int y = from; y < to; ++y)
    for (int x = from; x < to; ++x) put(tile_of(x, y, semantic_tile_t::ROAD));
}

semantic_tile_t PageOnABus::tile_of(int x, int y, std::int8_t cell_class) const {
  semantic_tile_t tile{};
  tile.utime = wall_clock();
  tile.epoch = epoch();
  tile.tile_x = x;
  tile.tile_y = y;
  std::fill(std::begin(tile.cell_class), std::end(tile.cell_class), static_cast<std::uint8_t>(cell_class));
  return tile;
}

PageOnABus::Rgb PageOnABus::colour_of(int cell_class) {
  static constexpr std::array<Rgb, 5> kColours = {
      {{243, 244, 241}, {190, 196, 203}, {233, 133, 8}, {126, 186, 232}, {28, 88, 160}}};  // page/drawing/palette.ts
  return kColours.at(static_cast<std::size_t>(cell_class));
}

void PageOnABus::open(const std::string& fragment) {
  browser->open(address + "#" + fragment);
  ASSERT_TRUE(browser->comes_to(
      fmt::format("curbstone.world.tiles.size === {} && curbstone.world.state && curbstone.world.changed.size === 0",
                  tiles.size())))
      << browser->evaluate("document.body.innerText");
}

PageOnABus::Spot PageOnABus::spot_of(double x, double y) {
  const auto spot = browser->evaluate(fmt::format("curbstone.camera.toScreen({}, {})", x, y));
  return {spot[0].get<double>(), spot[1].get<double>()};
}

int PageOnABus::wrong_cells(const semantic_tile_t& tile, const Picture& picture, int* seen) {
  // For each cell where the page has its middle; null where a card covers it.
  const auto spots = browser->evaluate(fmt::format(
      R"(Array.from({{ length: 625 }}, (_, i) => {{
           const spot = curbstone.camera.toScreen({} + (i % 25 + 0.5) * 0.12, {} + (Math.floor(i / 25) + 0.5) * 0.12);
           return document.getElementById("map").contains(document.elementFromPoint(...spot)) ? spot : null;
         }}))",
      3 * tile.tile_x, 3 * tile.tile_y));
  int wrong = 0;
  *seen = 0;
  for (std::size_t i = 0; i < spots.size(); ++i) {
    if (spots[i].is_null() || tile.cell_class[i] == 0) continue;  // under what is not known lies the page's grid
    ++*seen;
    const Rgb drawn = picture.at(spots[i][0].get<double>(), spots[i][1].get<double>());
    if (difference(drawn, colour_of(tile.cell_class[i])) > kTolerance) ++wrong;
  }
  return wrong;
}

std::string PageOnABus::text_of(const std::string& selector) {
  return browser->evaluate(fmt::format("document.querySelector('{}').innerText", selector));
}

void PageOnABus::keep_picture(const std::string& name) {
  const char* const folder = std::getenv("CURBSTONE_TEST_PICTURES");
  if (folder == nullptr) return;
  browser->pass(0.4);
  browser->save_picture(fmt::format("{}/{}.png", folder, name));
}

bool PageOnABus::shows(const std::string& selector, const std::string& words, double seconds) {
  return browser->comes_to(
      fmt::format(
          "document.querySelector('{0}').checkVisibility() && document.querySelector('{0}').innerText.includes('{1}')",
          selector, words),
      seconds);
}

}  // namespace curbstone::viewer
