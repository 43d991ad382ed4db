#include "common/shell/service.hpp"
#include "config/sections.hpp"
#include "services/tensor_voting/worker/tensor_voting_node.hpp"

int main(int argc, char** argv) {
  using namespace curbstone;
  return run_service<tensor_voting::worker::TensorVotingConfig>(
      argc, argv,
      {"tensor_voting", kProcessSections, "Votes on the points of the map: normals, tangents, saliency shares"},
      [](const tensor_voting::worker::TensorVotingConfig& config, ServiceContext& context) -> std::unique_ptr<Node> {
        return std::make_unique<tensor_voting::worker::TensorVotingNode>(config, context.name, context.bus);
      });
}
