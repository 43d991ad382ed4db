#include "common/shell/service.hpp"
#include "config/sections.hpp"
#include "services/semantic_map/semantic_map_node.hpp"

int main(int argc, char** argv) {
  using namespace curbstone;
  return run_service<semantic_map::SemanticMapConfig>(
      argc, argv,
      {.section = "semantic_map",
       .sections = kProcessSections,
       .description = "Curbs and the five-class map from voted points; keeps the map file",
       .alone = true},
      [](const semantic_map::SemanticMapConfig& config, ServiceContext& context) {
        return std::make_unique<semantic_map::SemanticMapNode>(config, context.bus,
                                                               semantic_map::store::UnusableFile::kWaits);
      });
}
