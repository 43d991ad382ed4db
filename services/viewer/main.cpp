#include <fmt/format.h>

#include <optional>
#include <string>

#include "common/shell/service.hpp"
#include "common/time/clock.hpp"
#include "config/sections.hpp"
#include "services/viewer/foxglove_node.hpp"
#include "services/viewer/viewer_node.hpp"
#include "services/viewer/web/web_server.hpp"

namespace {

using namespace curbstone;

/// The node and its web server.
class Viewer final : public Node {
 public:
  Viewer(const viewer::ViewerConfig& config, Publisher& bus)
      : server_(viewer::web_settings(config)), node_(config, bus, server_, {}) {
    if (config.port != 0 && server_.port() != config.port) fmt::print("viewer: port {} is taken\n", config.port);
    fmt::print("viewer: {}\n", viewer::page_address(config, server_.port()));
    if (config.foxglove_port != 0) open_door(config);
    std::fflush(stdout);
  }
  void connect(Subscriber& bus) override {
    node_.connect(bus);
    if (foxglove_) foxglove_->connect(bus);
  }
  void tick(std::int64_t now) override {
    node_.tick(now);
    if (foxglove_) foxglove_->tick(now);
  }
  [[nodiscard]] NodeReport report() const override {
    NodeReport report = node_.report();
    if (!foxglove_) return report;
    report.counters.add(foxglove_->report().counters);
    return report;
  }

 private:
  void open_door(const viewer::ViewerConfig& config) {
    endpoint_.emplace(viewer::endpoint_settings(config));
    foxglove_.emplace(config, node_, *endpoint_, std::to_string(wall_clock()));
    fmt::print("viewer: for Foxglove: ws://{}:{}\n", config.address, endpoint_->port());
  }

  viewer::web::WebServer server_;
  viewer::ViewerNode node_;
  std::optional<viewer::web::WebServer> endpoint_;
  std::optional<viewer::FoxgloveNode> foxglove_;
};

}  // namespace

int main(int argc, char** argv) {
  return run_service<viewer::ViewerConfig>(
      argc, argv, {"viewer", kProcessSections, "Shows the live map in a browser", std::chrono::milliseconds(10)},
      [](const viewer::ViewerConfig& config, ServiceContext& context) -> std::unique_ptr<Node> {
        return std::make_unique<Viewer>(config, context.bus);
      });
}
