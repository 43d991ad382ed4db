#include "common/shell/service.hpp"
#include "common/time/clock.hpp"
#include "config/sections.hpp"
#include "services/recorder/recorder_node.hpp"

using namespace curbstone;

int main(int argc, char** argv) {
  return run_service<recorder::RecorderConfig>(
      argc, argv,
      {"recorder", kProcessSections, "Writes everything on the bus to an LCM log", std::chrono::milliseconds(20)},
      [](const recorder::RecorderConfig& config, ServiceContext& context) -> std::unique_ptr<Node> {
        context.receive_large(config.large());
        return std::make_unique<recorder::RecorderNode>(config, context.everything, wall_clock());
      });
}
