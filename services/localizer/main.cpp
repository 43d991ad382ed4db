#include "common/shell/service.hpp"
#include "config/sections.hpp"
#include "services/localizer/localizer_node.hpp"

int main(int argc, char** argv) {
  using namespace curbstone;
  return run_service<localizer::LocalizerConfig>(argc, argv,
                                                 {.section = "localizer",
                                                  .sections = kProcessSections,
                                                  .description = "Says where the vehicle is in a saved semantic map",
                                                  .alone = true},
                                                 [](const localizer::LocalizerConfig& config, ServiceContext& context) {
                                                   return std::make_unique<localizer::LocalizerNode>(config,
                                                                                                     context.bus);
                                                 });
}
