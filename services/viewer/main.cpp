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
      : config_(config), server_(waiting(viewer::web_settings(config))), node_(config, bus, server_, {}) {
    if (config.foxglove_port != 0) {
      endpoint_.emplace(waiting(viewer::endpoint_settings(config)));
      foxglove_.emplace(config, node_, *endpoint_, std::to_string(wall_clock()));
    }
    say_addresses();
  }
  void connect(Subscriber& bus) override {
    node_.connect(bus);
    if (foxglove_) foxglove_->connect(bus);
  }
  void tick(std::int64_t now) override {
    node_.tick(now);
    if (foxglove_) foxglove_->tick(now);
    say_addresses();
  }
  [[nodiscard]] NodeReport report() const override {
    NodeReport report = node_.report();
    add_fault(report, "the page", server_);
    if (!foxglove_) return report;
    add_fault(report, "the port for Foxglove", *endpoint_);
    report.counters.add(foxglove_->report().counters);
    return report;
  }

 private:
  static viewer::web::WebSettings waiting(viewer::web::WebSettings settings) {
    settings.waits = true;
    return settings;
  }
  static void add_fault(NodeReport& report, const char* what, const viewer::web::WebServer& server) {
    const std::string why = server.fault();
    if (!why.empty()) report.faults.push_back(fmt::format("{} waits: {}", what, why));
  }
  /// Once each, as soon as they listen.
  void say_addresses() {
    if (!page_said_ && server_.port() != 0) {
      if (config_.port != 0 && server_.port() != config_.port) fmt::print("viewer: port {} is taken\n", config_.port);
      fmt::print("viewer: {}\n", viewer::page_address(config_, server_.port()));
      std::fflush(stdout);
      page_said_ = true;
    }
    if (!foxglove_said_ && endpoint_ && endpoint_->port() != 0) {
      fmt::print("viewer: for Foxglove: ws://{}:{}\n", config_.address, endpoint_->port());
      std::fflush(stdout);
      foxglove_said_ = true;
    }
  }

  viewer::ViewerConfig config_;
  bool page_said_ = false;
  bool foxglove_said_ = false;
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
