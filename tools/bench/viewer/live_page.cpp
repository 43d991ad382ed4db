#include "tools/bench/viewer/live_page.hpp"

#include <curbstone/map_pose_t.hpp>
#include <stdexcept>

#include "common/time/clock.hpp"

namespace curbstone::bench::viewer {
namespace {

using curbstone::viewer::ViewerConfig;
using curbstone::viewer::ViewerNode;
namespace web = curbstone::viewer::web;

constexpr std::int64_t kRevolution = 50'000;  // us
constexpr double kPatience = 240;             // s

}  // namespace

LivePage::LivePage() : epoch_(static_cast<std::int32_t>(wall_clock() / 1'000'000)), browser_([this] { go_on(); }) {
  ViewerConfig config;
  config.port = 0;
  server_ = std::make_unique<web::WebServer>(curbstone::viewer::web_settings(config));
  node_ = std::make_unique<ViewerNode>(config, bus_, *server_, ViewerNode::Source{});
  node_->connect(bus_);
  node_->tick(wall_clock());
  address_ = curbstone::viewer::page_address(config, server_->port());
}

void LivePage::put(semantic_tile_t tile) {
  tile.epoch = epoch_;
  tile.utime = wall_clock();
  tile.revision = ++revision_;
  bus_.publish("SEMANTIC_TILE", tile);
  bus_.dispatch();
}

void LivePage::open(const std::string& fragment) {
  browser_.open(address_ + "#" + fragment);
}

void LivePage::wait_for(const std::string& condition) {
  if (!browser_.comes_to(condition, kPatience)) throw std::runtime_error("the page does not come to " + condition);
}

void LivePage::go_on() {
  if (!node_) return;
  const std::int64_t now = wall_clock();
  if (now - said_ >= kRevolution) {
    said_ = now;
    map_pose_t pose{};
    pose.utime = now;
    pose.epoch = epoch_;
    pose.map_base_orientation[0] = pose.map_odom_orientation[0] = 1;
    pose.flags = map_pose_t::REGISTERED;
    bus_.publish("MAP_POSE", pose);
  }
  meanwhile();
  bus_.dispatch();
  node_->tick(now);
}

}  // namespace curbstone::bench::viewer
