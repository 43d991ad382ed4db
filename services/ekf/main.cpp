#include "common/service.hpp"
#include "services/ekf/ekf_node.hpp"

using namespace curbstone;

int main(int argc, char** argv) {
  return run_service<EkfConfig>(argc, argv, "ekf", "Wheel and IMU odometry by an error-state Kalman filter",
                                [](const EkfConfig& config, ServiceContext& context) -> std::unique_ptr<Node> {
                                  return std::make_unique<EkfNode>(config, context.bus);
                                });
}
