#include "common/shell/service.hpp"
#include "config/sections.hpp"
#include "services/mapper/mapper_node.hpp"

int main(int argc, char** argv) {
  using namespace curbstone;
  return run_service<mapper::config::MapperConfig>(
      argc, argv,
      {.section = "mapper",
       .sections = kProcessSections,
       .description = "De-skews, registers and maps the LiDAR's revolutions",
       .alone = true},
      [](const mapper::config::MapperConfig& config, ServiceContext& context) {
        return std::make_unique<mapper::MapperNode>(config, context.bus);
      });
}
