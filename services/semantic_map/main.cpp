#include "common/service.hpp"
#include "services/semantic_map/semantic_map_node.hpp"

int main(int argc, char** argv) {
  using namespace curbstone;
  return run_service<SemanticMapConfig>(argc, argv, "semantic_map",
                                        "Curbs and the five-class map from voted points; keeps the map file",
                                        [](const SemanticMapConfig& config, ServiceContext& context) {
                                          return std::make_unique<SemanticMapNode>(config, context.bus);
                                        });
}
