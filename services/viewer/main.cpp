#include <fmt/format.h>

#include "common/shell/service.hpp"
#include "config/sections.hpp"
#include "services/viewer/viewer_node.hpp"
#include "services/viewer/web/web_server.hpp"

namespace {

using namespace curbstone;

/// The node and the server that it sends by.
class Viewer final : public Node {
 public:
  Viewer(const viewer::ViewerConfig& config, Publisher& bus)
      : server_(viewer::web_settings(config)), node_(config, bus, server_, {}) {
    if (config.port != 0 && server_.port() != config.port) fmt::print("viewer: port {} is taken\n", config.port);
    fmt::print("viewer: {}\n", viewer::page_address(config, server_.port()));
    std::fflush(stdout);
  }
  void connect(Subscriber& bus) override { node_.connect(bus); }
  void tick(std::int64_t now) override { node_.tick(now); }
  [[nodiscard]] NodeReport report() const override { return node_.report(); }

 private:
  viewer::web::WebServer server_;
  viewer::ViewerNode node_;
};

}  // namespace

int main(int argc, char** argv) {
  return run_service<viewer::ViewerConfig>(
      argc, argv, {"viewer", kProcessSections, "Shows the live map in a browser"},
      [](const viewer::ViewerConfig& config, ServiceContext& context) -> std::unique_ptr<Node> {
        return std::make_unique<Viewer>(config, context.bus);
      });
}
