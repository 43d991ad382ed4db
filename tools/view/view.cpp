#include "tools/view/view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/bus/local_bus.hpp"
#include "common/config/assignments.hpp"
#include "common/config/command_line.hpp"
#include "common/config/config.hpp"
#include "common/shell/event_loop.hpp"
#include "common/time/clock.hpp"
#include "config/sections.hpp"
#include "services/viewer/foxglove_node.hpp"
#include "services/viewer/viewer_node.hpp"
#include "services/viewer/web/web_server.hpp"
#include "tools/view/drive.hpp"
#include "tools/view/saved_map.hpp"

namespace curbstone::view {
namespace {

constexpr std::array<std::string_view, 1> kSections = {"viewer"};

struct ViewOptions {
  std::vector<std::string> files;
  std::string config;
  std::vector<std::string> assignments;
  double speed = 1;
  double from = 0;  // s
};

/// A drive that is played for the page, with the page's commands.
class Playing {
 public:
  Playing(std::vector<std::string> logs, double speed, LocalBus& shown)
      : logs_(std::move(logs)), shown_(shown), speed_(speed), drive_(std::make_unique<Drive>(logs_, shown)) {
    drive_->set_speed(speed_);
  }

  void obey(const viewer::ViewerNode::PlaybackCommand& order, viewer::ViewerNode& node) {
    if (order.pause) paused_ = *order.pause;
    if (order.speed) speed_ = *order.speed;
    if (order.position) {
      const auto place = static_cast<std::int64_t>(std::min(*order.position, kMaxTime) * 1e6);
      if (place < drive_->position()) {
        drive_ = std::make_unique<Drive>(logs_, shown_);
        node.restart();
      }
      drive_->go_to(place);
    }
    drive_->set_paused(paused_);
    drive_->set_speed(speed_);
  }

  void advance() { drive_->advance(steady_clock()); }
  [[nodiscard]] viewer::Playback state() const {
    const play::Player& player = drive_->player();
    return {.position = static_cast<double>(player.position()) * 1e-6,
            .progress = player.progress(),
            .speed = player.speed(),
            .paused = player.paused(),
            .ended = player.at_end()};
  }
  [[nodiscard]] const Drive& drive() const { return *drive_; }

 private:
  static constexpr double kMaxTime = 1e6;  // s

  std::vector<std::string> logs_;
  LocalBus& shown_;
  double speed_;
  bool paused_ = false;
  std::unique_ptr<Drive> drive_;
};

/// The page of a drive shows the vehicle that recorded it; its address and port are for this host to say.
viewer::ViewerConfig viewer_for(const ViewOptions& options, bool is_map) {
  ConfigOf<viewer::ViewerConfig> config;
  if (!options.config.empty()) {
    load_config(options.config, "viewer", kProcessSections, config);
  } else if (!is_map) {
    config.value.vehicle = recorded_vehicle(options.files);
  }
  set_section_values("viewer", options.assignments, config);
  return config.value;
}

std::string title_of(const std::vector<std::string>& files) {
  const std::string first = std::filesystem::path(files[0]).filename().string();
  return files.size() == 1 ? first : fmt::format("{} and {} more", first, files.size() - 1);
}

/// Serves until it is stopped.
void serve(EventLoop& loop, LocalBus& bus, viewer::ViewerNode& node, Playing* playing, ShownMap* map,
           viewer::FoxgloveNode* foxglove) {
  if (map != nullptr) loop.every(std::chrono::seconds(1), [map] { map->look(wall_clock()); });
  loop.every(std::chrono::milliseconds(20), [&] {
    if (playing != nullptr) {
      playing->advance();
      node.set_playback(playing->state());
    }
    bus.dispatch();
    node.tick(wall_clock());
    if (foxglove != nullptr) foxglove->tick(wall_clock());
  });
  loop.run();
}

}  // namespace

int run_view(int argc, char** argv) {
  ViewOptions options;
  CommandLine line(
      "Shows a saved map, or plays a drive, in a browser: the page of curbstone-viewer. Nothing goes to a bus, and "
      "nothing is written. Ctrl-C ends it",
      "curbstone view");
  line.option("file", options.files, "A map (map.db), or LCM logs of one drive, or the folder of a session").required();
  line.option("--speed", options.speed, "Times the pace of the drive").within(0.01, 100.0).shows_default();
  line.option("--from", options.from, "s of the drive at which to begin").within(0.0, 1e6).shows_default();
  line.option("--config", options.config, "The vehicle's YAML file, of which 'viewer' is read");
  line.option("--set", options.assignments, "viewer.KEY=VALUE, over the file: viewer.port=8090, say").one_each();
  if (const auto status = line.read(argc, argv)) return *status;
  options.assignments = assignments_for(kSections, options.assignments);

  EventLoop loop;  // before the web server's thread
  const bool is_map = is_map_file(options.files[0]);
  viewer::ViewerConfig config = viewer_for(options, is_map);
  // Several viewers may run: that of a vehicle, which has the first port, and others like this one.
  if (!line.given("--config") && config.ports == 1) config.ports = 20;
  if (is_map && options.files.size() > 1) throw std::runtime_error("one map at a time");

  LocalBus bus;
  std::unique_ptr<Playing> playing;
  if (!is_map) playing = std::make_unique<Playing>(options.files, options.speed, bus);
  viewer::web::WebServer server(viewer::web_settings(config));
  viewer::ViewerNode::Source source{.kind = is_map ? "map" : "replay", .title = title_of(options.files)};
  viewer::ViewerNode* shown = nullptr;
  if (playing) source.on_order = [&](const auto& order) { playing->obey(order, *shown); };
  viewer::ViewerNode node(config, bus, server, source);
  shown = &node;
  node.connect(bus);
  std::optional<viewer::web::WebServer> endpoint;
  std::optional<viewer::FoxgloveNode> foxglove;
  if (config.foxglove_port != 0) {
    endpoint.emplace(viewer::endpoint_settings(config));
    foxglove.emplace(config, node, *endpoint, std::to_string(wall_clock()));
    foxglove->connect(bus);
    fmt::print("view: for Foxglove: ws://{}:{}\n", config.address, endpoint->port());
  }
  node.tick(wall_clock());
  if (playing && options.from > 0) playing->obey({.pause = {}, .speed = {}, .position = options.from}, node);
  std::optional<ShownMap> map;
  if (is_map) map.emplace(options.files[0], source.title, node).show(wall_clock());
  fmt::print("view: {}{}\n", viewer::page_address(config, server.port()),
             playing && playing->drive().makes_map() ? " (the log has no map: it is made from the sensors)" : "");
  std::fflush(stdout);
  serve(loop, bus, node, playing.get(), map ? &*map : nullptr, foxglove ? &*foxglove : nullptr);
  return 0;
}

}  // namespace curbstone::view
