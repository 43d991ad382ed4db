#include "common/service.hpp"
#include "services/mapper/mapper_node.hpp"

int main(int argc, char** argv) {
  using namespace curbstone;
  return run_service<MapperConfig>(argc, argv, "mapper", "De-skews, registers and maps the LiDAR's revolutions",
                                   [](const MapperConfig& config, ServiceContext& context) {
                                     return std::make_unique<MapperNode>(config, context.bus);
                                   });
}
