#include "common/shell/service.hpp"
#include "config/sections.hpp"
#include "services/ekf/ekf_node.hpp"

using namespace curbstone;

int main(int argc, char** argv) {
  return run_service<ekf::base::EkfConfig>(
      argc, argv,
      {.section = "ekf",
       .sections = kProcessSections,
       .description = "Wheel and IMU odometry by an error-state Kalman filter",
       .alone = true},
      [](const ekf::base::EkfConfig& config, ServiceContext& context) -> std::unique_ptr<Node> {
        return std::make_unique<ekf::EkfNode>(config, context.bus);
      });
}
