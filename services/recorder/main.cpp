#include "common/service.hpp"
#include "services/recorder/recorder_node.hpp"

using namespace curbstone;

int main(int argc, char** argv) {
  return run_service<RecorderConfig>(
      argc, argv, "recorder", "Writes everything on the bus to an LCM log",
      [](const RecorderConfig& config, ServiceContext& context) -> std::unique_ptr<Node> {
        return std::make_unique<RecorderNode>(config, context.everything);
      });
}
